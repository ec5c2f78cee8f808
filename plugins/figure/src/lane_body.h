#pragma once

#include "lane_math.h"
#include "softpoint/figure/joint_kind.h"

// No standard library and no Eigen here: see lane_math.h.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// A body's axes at q = 0 in its parent's.
enum class LaneTurn : signed char {
  kNone,
  kQuarter,  // about x
  kHalf,     // about x
  kAboutX,
  kGeneral,
};

// How a walk meets one body of a tree (or one row of bodies, side by side in the lanes of a pack). Parents go
// first. What a walk holds of bodies on the way is kept in a few slots that are used again: the last child
// of a body takes over its slot.
struct LaneStep {
  JointKind joint = JointKind::kHinge;
  LaneTurn turn = LaneTurn::kGeneral;
  bool armed = true;    // its joint is not where the parent's is
  bool massive = true;  // it, and not only its children, has mass
  bool whirls = true;   // it has mass or an armed child
  bool leaf = true;     // nothing hangs on it
  bool damped = false;  // its joint has viscous friction
  bool over = true;     // takes over its parent's slot
  bool root = true;     // hangs on the world
  int slot = 0, parent_slot = 0;
  int q = 0, v = 0;  // where the joint's numbers begin
  int ball = 0;      // balls: which one
};

// Constants of a body, as in TreeBody but for the axes: those of a hinge are turned about it, and with them
// all lengths, so that its child's axis lies in the plane of y and z. C is double, or a pack where every lane
// has a body of its own.
template <class C>
struct LaneBody {
  M3<C> turn;
  C offset;  // rad, added to a hinge's angle
  V3<C> origin;
  C mass;
  V3<C> first_moment;
  S3<C> inertia;
  C armature;
  C damping;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
