#pragma once

#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The state at the share `u` (0 to 1) of the way from one to another, `h` s apart, on cubics that meet
// positions and rates of both. Allocates nothing if `to` has its size already.
void state_between(const FigureModel& model, const FigureState& from, const FigureState& until, double h,
                   double u, FigureState& to);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
