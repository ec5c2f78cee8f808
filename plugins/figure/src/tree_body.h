#pragma once

#include "lane_math.h"
#include "softpoint/figure/joint_kind.h"

// No standard library and no Eigen here: see lane_math.h.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// A body of the tree as the recursions want it: links joined by fixed joints are one body, and its axes are
// turned so that the joint's axis is z (hinge, prismatic), which saves a rotation about a general axis. All
// lengths are in these axes, with the origin at the joint.
struct TreeBody {
  int parent = -1;
  JointKind joint = JointKind::kHinge;
  int q = 0, v = 0;  // where the joint's numbers begin
  int dofs = 0;
  int ball = 0;  // ball joints: which one; of others 0
  bool massless = false;
  bool armed = true;        // its joint is not where the parent's is
  M3<double> turn;          // this body's axes in the parent's at q = 0
  V3<double> origin;        // m, in the parent's axes
  double mass = 0;          // kg
  V3<double> first_moment;  // kg m: mass times centre of mass
  S3<double> inertia;       // kg m2, about the joint
  double armature = 0;
  double damping = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
