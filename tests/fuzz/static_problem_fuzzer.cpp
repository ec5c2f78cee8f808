// Problem files of `softpoint solve`: read, and solved where the stiffness is at hand.
#include "fuzz/fuzz_support.h"
#include "json_reader.h"
#include "softpoint/core/error.h"
#include "static_problem_file.h"

using namespace softpoint;

namespace {

// Assembled once: of the one mesh that the corpus names, for the one Poisson's ratio.
const std::shared_ptr<const elastic::BoundaryStiffness>& known_stiffness(
    const elastic::StaticProblem& problem) {
  static const auto made = [&] {
    elastic::StiffnessSettings settings;
    settings.keep_traction = true;
    return elastic::assemble_stiffness(problem.mesh, problem.material.poisson, settings);
  }();
  return made;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (size > 1 << 14 || fuzz::names_devices(text)) return 0;
  try {
    elastic::StaticProblem problem;
    scene::read_json_text(text, "problem.json", SOFTPOINT_SCENES_FOLDER,
                          [&](scene::ObjectReader& root) { scene::read_static_problem(root, problem); });
    if (problem.mesh.vertex_count() > 20 || problem.material.poisson != 0.3) return 0;
    scene::static_result_json(elastic::solve_statics(problem, known_stiffness(problem)));
  } catch (const Error&) {
  }
  return 0;
}
