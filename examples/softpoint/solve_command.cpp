#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "command.h"
#include "softpoint/core/atomic_file.h"
#include "softpoint/core/error.h"
#include "static_problem_file.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

struct SolveOptions {
  std::string problem;
  std::string out;
};

int solve(const SolveOptions& options) {
  // Before the work, not after it.
  check_writable(options.out);
  const elastic::StaticProblem problem = read_static_problem(options.problem);
  elastic::StaticResult result;
  try {
    result = elastic::solve_statics(problem);
  } catch (const Error& error) {
    throw Error(options.problem + ": " + error.what());
  }
  write_atomically(options.out, static_result_json(result));
  fmt::print("{}: {} vertices, {} triangles, strain energy {} J, {:.3f} s\n", options.out,
             problem.mesh.vertex_count(), problem.mesh.triangle_count(), to_text(result.energy),
             result.seconds.total);
  return kExitDone;
}

}  // namespace

Command add_solve_command(CLI::App& program) {
  auto options = std::make_shared<SolveOptions>();
  CLI::App* app = program.add_subcommand("solve", "Elastostatics of one body");
  app->add_option("PROBLEM", options->problem, "Problem file (JSON; see: softpoint schema solve)")
      ->required();
  app->add_option("--out", options->out, "Result file (JSON)")->required();
  return {app, [options] { return solve(*options); }};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
