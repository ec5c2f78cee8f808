#include "document_kinds.h"

#include "scene_reader.h"
#include "static_problem_file.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

std::vector<DocumentKind> document_kinds() {
  Scene played;
  elastic::StaticProblem problem;
  return {
      {"play", "SCENE.json of `softpoint play`",
       describe([&](ObjectReader& root) { read_scene(root, deformable_plugins(), played); })},
      {"solve", "PROBLEM.json of `softpoint solve`",
       describe([&](ObjectReader& root) { read_static_problem(root, problem); })},
  };
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
