#pragma once

#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

class PartGroup;

// Which joints of a group act on one another, and the order in which they are eliminated: fewest neighbours
// first, so that chains and trees leave no more blocks than they had.
struct JointGraph {
  struct Coupling {
    int joint = 0;  // eliminated later
    int link = 0;   // number of the block
  };
  // With `bones` those coupled by the angle forces of bones count too: every joint with the next but one.
  JointGraph(const PartGroup& group, bool bones);

  std::vector<std::vector<int>> segment_joints;  // of each segment, interface by interface
  std::vector<int> order;
  std::vector<std::vector<Coupling>> couplings;  // of each joint
  int links = 0;

  // The block of two joints, the first eliminated before the other; -1 for none.
  int link_of(int first, int later) const;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
