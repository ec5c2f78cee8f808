#pragma once

#include <functional>
#include <string>
#include <vector>

#include "softpoint/core/config.h"

namespace CLI {
class App;
}

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What the shell is told.
inline constexpr int kExitDone = 0;
inline constexpr int kExitRefused = 1;  // input refused; one line on stderr says why
inline constexpr int kExitUsage = 2;    // the command line itself is wrong

// A subcommand of the program: its options stand in `app`; `run`, called after parsing, gives the exit
// code and throws Error for refused input.
struct Command {
  CLI::App* app;
  std::function<int()> run;
};

// One function a subcommand, each in a file of its own. `arguments` are those of the whole program.
Command add_play_command(CLI::App& program, const std::vector<std::string>& arguments);
Command add_solve_command(CLI::App& program);
Command add_figure_command(CLI::App& program);
Command add_schema_command(CLI::App& program);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
