#include "walk_plan.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::figure {

WalkPlan::WalkPlan(const Tree& tree) : dynamic(tree.bodies.size(), 1), bears(tree.bodies.size(), 0) {
  placed.reserve(tree.bodies.size());
  articulated.reserve(tree.bodies.size());
  rebuild(tree);
}

void WalkPlan::rebuild(const Tree& tree) {
  placed.clear();
  articulated.clear();
  all_dynamic = std::find(dynamic.begin(), dynamic.end(), 0) == dynamic.end();
  const int count = static_cast<int>(tree.bodies.size());
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int parent = tree.bodies[k].parent;
    bears[k] = dynamic[k] || (parent >= 0 && bears[static_cast<std::size_t>(parent)] == 1);
  }
  // Leads to a dynamic joint: marked by 2 for a moment, children first.
  for (int i = count - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const int parent = tree.bodies[k].parent;
    if (bears[k] != 0 && parent >= 0 && bears[static_cast<std::size_t>(parent)] == 0) {
      bears[static_cast<std::size_t>(parent)] = 2;
    }
  }
  for (int i = 0; i < count; ++i) {
    char& mark = bears[static_cast<std::size_t>(i)];
    if (mark != 0) placed.push_back(i);
    if (mark == 1) articulated.push_back(i);
    if (mark == 2) mark = 0;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
