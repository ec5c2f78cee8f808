#include "document_kinds.h"

#include "static_problem_file.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

std::vector<DocumentKind> document_kinds() {
  elastic::StaticProblem problem;
  return {
      {"solve", "PROBLEM.json of `softpoint solve`",
       describe([&](ObjectReader& root) { read_static_problem(root, problem); })},
  };
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
