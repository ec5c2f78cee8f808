#include "softpoint/core/atomic_file.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Distinct for every write of every process that shares a folder.
std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  std::filesystem::path result = path;
  result += ".part-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
  return result;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& reason) {
  throw Error(path.string() + ": cannot be written (" + reason +
              "); name a file in a folder that exists and is writable");
}

}  // namespace

void write_atomically(const std::filesystem::path& path, std::string_view content) {
  const std::filesystem::path temporary = temporary_beside(path);
  std::error_code ignored;
  {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out) {
      const std::string reason = errno != 0 ? std::strerror(errno) : "write failed";
      std::filesystem::remove(temporary, ignored);
      refuse(path, reason);
    }
  }
  std::error_code error;
  std::filesystem::rename(temporary, path, error);
  if (error) {
    std::filesystem::remove(temporary, ignored);
    refuse(path, error.message());
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
