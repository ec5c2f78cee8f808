#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// How a link moves against its parent.
enum class JointKind {
  kFixed,
  kHinge,      // turns about `axis`
  kPrismatic,  // slides along `axis`
  kBall,       // turns freely
  kFree        // six degrees of freedom; only for links whose parent is the world
};
SOFTPOINT_API const char* name(JointKind kind);
// Numbers in a state's `q` and `qd`: hinge and prismatic 1 (rad, m) and 1; ball 4 (quaternion w, x, y, z,
// child to parent) and 3 (angular velocity against the parent, in the child's axes); free 7 (position of the
// joint, m, then quaternion w, x, y, z) and 6 (angular velocity, then velocity of the joint, world axes).
SOFTPOINT_API int position_count(JointKind kind);
SOFTPOINT_API int velocity_count(JointKind kind);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
