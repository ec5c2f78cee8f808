#pragma once

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A ball's turn, child to parent, as R = exp(swing) exp(twist axis): first about the link's `axis`, then
// about an axis across it.
struct SwingTwist {
  Vec3 swing = Vec3::Zero();  // turn vector across `axis`, rad, 0 to pi, in the link's frame
  double twist = 0;           // rad, -pi to pi
};
// Of the unit quaternion `q` (w, x, y, z); the link's axes are those of a checked model.
SOFTPOINT_API SwingTwist swing_twist(const Link& link, const double* q);
// The unit quaternion of a swing across `axis` and a twist.
SOFTPOINT_API void set_swing_twist(const Link& link, const SwingTwist& turn, double* q);

// Farthest that any joint is outside its range, rad or m; 0 for a figure that is inside.
SOFTPOINT_API double outside_ranges(const FigureModel& model, const FigureState& state);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
