#pragma once

#include <vector>

#include "tree.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Which bodies the recursions visit for a choice of dynamic joints.
struct WalkPlan {
  explicit WalkPlan(const Tree& tree);
  // After a change of `dynamic`. Allocates nothing.
  void rebuild(const Tree& tree);

  bool all_dynamic = true;
  // Per body.
  std::vector<char> dynamic;
  std::vector<char> bears;  // a joint between it and the world, its own included, is dynamic
  // Bodies, parents first: those on the way from the world to a dynamic joint or behind one; those that bear.
  std::vector<int> placed, articulated;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
