#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "command.h"
#include "sibling.h"

namespace {

using namespace softpoint;

// Refusals are one line, whatever a file name in them holds.
void complain(std::string message) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "softpoint: {}\n", message);
}

int run(int argc, char** argv) {
  CLI::App program{"Soft bodies in Bullet worlds", "softpoint"};
  program.require_subcommand(1);
  program.set_version_flag(
      "--version",
      fmt::format("softpoint {}.{}.{} ({} precision)", kVersionMajor, kVersionMinor, kVersionPatch,
                  scene::kBuiltPrecision == scene::Precision::kDouble ? "double" : "single"));
  const std::vector<scene::Command> commands = {
      scene::add_play_command(program, {argv, argv + argc}),
      scene::add_solve_command(program),
      scene::add_figure_command(program),
      scene::add_schema_command(program),
  };
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? scene::kExitDone : scene::kExitUsage;
  }
  for (const scene::Command& command : commands) {
    if (command.app->parsed()) {
      return command.run();
    }
  }
  return scene::kExitUsage;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    complain("out of memory");
  } catch (const std::exception& error) {
    complain(error.what());
  }
  return softpoint::scene::kExitRefused;
}
