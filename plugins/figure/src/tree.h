#pragma once

#include <vector>

#include "softpoint/figure/figure_model.h"
#include "tree_body.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where a link's own frame lies on the body that carries it; body -1 is the world.
struct LinkPlace {
  int body = -1;
  M3<double> turn;
  V3<double> origin;
};

struct Tree {
  std::vector<TreeBody> bodies;   // parents before children
  std::vector<LinkPlace> places;  // one a link
  int balls = 0;
};

Tree build_tree(const FigureModel& model);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
