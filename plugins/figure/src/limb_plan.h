#pragma once

#include <vector>

#include "limb_walk.h"
#include "pack_array.h"
#include "placing-inl.h"
#include "softpoint/core/instruction_set.h"
#include "tree.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A figure's limbs side by side in the lanes of packs: every lane is the way from the root to one leaf, every
// row one body of each way, as far from its leaf as the others of the row. Where a way has no body in a row
// its lane has an idle one there, without mass and with a joint too heavy to move; what several ways share is
// computed in the lanes of all of them, after what hangs on it has been added up across the lanes.
class LimbPlan {
 public:
  // Not usable() where that would not pay: too few or too many limbs, or joints other than hinges and one
  // free root. `most`: the best instruction set to use.
  LimbPlan(const Tree& tree, InstructionSet most);

  bool usable() const { return walker_.lanes > 0; }
  void forward(const V3<double>& world, const double* q, const double* qd, const double* tau, double* qdd);
  // What forward() has found of each body, as the walks of a single figure leave it: axes, arm, reach, pivot,
  // push; of a free root its inertia.
  void unpack(std::vector<BodyWork<double>>& work) const;

 private:
  struct Place {
    int row, lane;
    double cosine, sine;  // of the angle that the body's axes are turned by
  };
  LimbWalker walker_;
  std::vector<LaneStep> steps_;
  std::vector<Place> places_;  // one a body
  std::vector<int> q_index_, v_index_, result_, sum_begins_;
  std::vector<LimbSum> sums_;
  PackArray bodies_, q_live_, v_live_, sum_lanes_, work_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
