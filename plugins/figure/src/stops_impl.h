#pragma once

#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

inline constexpr int kMostReleases = 16;    // of a joint in a step: then it leans to the step's end
inline constexpr double kRounding = 1e-13;  // of the largest torque, acceleration or impulse

inline double sign_of(Stop stop) { return static_cast<double>(stop); }

// Which stop a joint touches.
inline Stop touched(double q, double lower, double upper) {
  return q <= lower ? Stop::kLower : q >= upper ? Stop::kUpper : Stop::kFree;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
