#pragma once

#include "softpoint/figure/swing_twist.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The range of a ball joint as two functions of its turn with their derivatives: (28) to (31) of
// doc/dynamics.md. Both are smooth for swings below pi.
class BallRange {
 public:
  explicit BallRange(const Link& link);

  // In the frame of swing_axis, axis x swing_axis and axis: the swing's two components and the twist (rad);
  // the twist is the one next to the middle of its range.
  struct Turn {
    double x = 0, y = 0, twist = 0;
  };
  Turn turn(const double* q) const;
  void set(const Turn& turn, double* q) const;
  Vec3 swing(const Turn& turn) const { return frame_.col(0) * turn.x + frame_.col(1) * turn.y; }

  // Above zero outside the cone; there and near it in rad.
  double excess(const Turn& turn) const;
  double size() const { return size_; }  // rad, the smaller half angle
  // The swing on the cone in the same direction.
  Turn on_cone(Turn turn) const;

  // One function's rate is gradient . spin and its second derivative gradient . spin' + bias, the spin being
  // the joint's own (rad/s, link's axes).
  struct Row {
    Vec3 gradient = Vec3::Zero();
    double bias = 0;
  };
  Row swing_row(const Turn& turn, const Vec3& spin) const;
  Row twist_row(const Turn& turn, const Vec3& spin) const;

  // Of turns to be gone through at once (rad): the cone is not left on its far side, and its row turns
  // little.
  double farthest() const { return farthest_; }

 private:
  Mat3 frame_;
  double about_, across_, size_, middle_, farthest_;
};

// Whether a joint has a range; whether it is inside, up to a slack (rad or m); the nearest position inside
// put into its numbers `q`; all ranges opened; a range widened so that `q` is inside.
bool has_range(const Link& link);
double outside_range(const Link& link, const double* q);
void put_inside(const Link& link, double* q);
void open_range(Link& link);
void widen_range(Link& link, const double* q);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
