#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "softpoint/core/config.h"
#include "support/temporary_folder.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Runs the program in a folder of the test's own, with what it prints in the files stdout and stderr there.
class Play : public ::testing::Test {
 protected:
  std::filesystem::path in_folder(const std::string& name) const { return folder_.path() / name; }

  std::string text(const std::string& name) const {
    std::ifstream in(in_folder(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  int play(const std::string& arguments) const {
    const std::string scene = std::string(SOFTPOINT_EXAMPLES_FOLDER) + "/scenes/falling_box.json";
    return run("play " + scene + " " + arguments);
  }

  int run(const std::string& arguments) const {
    const std::string command =
        "cd " + folder_.path().string() + " && " + SOFTPOINT_PROGRAM + " " + arguments + " >stdout 2>stderr";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryFolder folder_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
