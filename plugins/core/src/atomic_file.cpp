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

std::filesystem::path behind_links(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::canonical(path, error);
  return error ? path : target;
}

}  // namespace

void check_writable(const std::filesystem::path& path) {
  const std::filesystem::path target = behind_links(path);
  std::error_code error;
  const auto status = std::filesystem::status(target, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    refuse(path, "it is no regular file");
  }
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
  if (!std::filesystem::is_directory(folder, error)) {
    refuse(path, "there is no folder " + folder.string());
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    refuse(path, std::strerror(errno));
  }
}

void write_atomically(const std::filesystem::path& path, std::string_view content) {
  check_writable(path);
  const std::filesystem::path target = behind_links(path);
  const std::filesystem::path temporary = temporary_beside(target);
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
  std::filesystem::rename(temporary, target, error);
  if (error) {
    std::filesystem::remove(temporary, ignored);
    refuse(path, error.message());
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
