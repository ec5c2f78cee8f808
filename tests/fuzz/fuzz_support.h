#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

// What fuzzers share. Whatever a reader makes of an input, it either gives a result that its own checks vouch
// for or throws softpoint::Error; any other exception, a signal or a sanitizer's report is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace softpoint::fuzz {

// A promise that the program would rely on is broken.
inline void require(bool promise, const char* what) {
  if (!promise) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

// A file in memory, for readers that take a path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    require(descriptor_ >= 0, "there is memory for a file");
    for (std::size_t done = 0; done < content.size();) {
      const ssize_t put = ::write(descriptor_, content.data() + done, content.size() - done);
      require(put > 0, "the file in memory takes its content");
      done += static_cast<std::size_t>(put);
    }
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  int descriptor_;
};

// Documents name files: none of those the system makes up, which may never end.
inline bool names_devices(std::string_view text) {
  for (const char* place : {"/dev", "/proc", "/sys", "\\u"}) {  // escapes could spell the others
    if (text.find(place) != std::string_view::npos) return true;
  }
  return false;
}

}  // namespace softpoint::fuzz
