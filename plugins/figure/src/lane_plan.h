#pragma once

#include <vector>

#include "lane_body.h"
#include "tree.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The constants of bodies with their axes turned: see LaneBody. All one a body of the tree.
struct StraightBodies {
  struct Twist {
    double cosine = 1, sine = 0;
  };
  std::vector<LaneBody<double>> bodies;
  std::vector<Twist> twists;  // about z, from the axes of the tree's body to these
  std::vector<std::vector<int>> children;
};

StraightBodies straighten(const Tree& tree);
// What a walk does there; its slots are left to be chosen.
LaneStep lane_step(const Tree& tree, const StraightBodies& straight, int body);

// A tree as walks in packs meet it.
struct LanePlan {
  std::vector<LaneStep> steps;
  std::vector<LaneBody<double>> bodies;
  int slots = 0;
};

LanePlan plan_lanes(const Tree& tree);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
