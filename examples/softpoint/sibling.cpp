#include "sibling.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

std::filesystem::path sibling_path(Precision precision) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) {
    throw Error("/proc/self/exe: cannot be read (" + error.message() + ")");
  }
  return self.parent_path() / (precision == Precision::kDouble ? "softpoint-float64" : "softpoint");
}

void exec_sibling(Precision precision, const std::vector<std::string>& arguments) {
  if (precision == kBuiltPrecision) {
    return;
  }
  const std::string program = sibling_path(precision).string();
  std::vector<std::string> copies = arguments;
  std::vector<char*> argv;
  for (std::string& argument : copies) {
    argv.push_back(argument.data());
  }
  argv.push_back(nullptr);
  std::fflush(nullptr);
  ::execv(program.c_str(), argv.data());
  throw Error(fmt::format("{}: cannot be run ({}); build the {} precision, or leave --precision out", program,
                          std::strerror(errno), precision == Precision::kDouble ? "double" : "single"));
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
