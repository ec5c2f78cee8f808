#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Value and rate at both ends of [0, length].
struct CubicSpan {
  double value0, rate0, value1, rate1, length;
};

// First t in (0, length] at which Hermite's cubic goes from not above zero to above it, and a later `beyond`
// at which it is above zero; false when it never does.
bool first_crossing(const CubicSpan& span, double& t, double& beyond);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
