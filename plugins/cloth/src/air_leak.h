#pragma once

#include <span>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// A way for air in or out: conductance * (|dp| - threshold) m3/s once |dp| exceeds the threshold.
struct Opening {
  double conductance = 0;  // m3/(s Pa)
  double threshold = 0;    // Pa
};

// Air (J) of a pocket of constant volume (m3, > 0) after `dt` seconds of flow through its openings, measured
// at the pressure where the air comes from, implicit in the pressure: it goes towards `ambient` (Pa) and
// never past it. `floor` (Pa) is the least pressure there can be, whatever the air.
double air_after_leak(double air, double volume, double dt, double ambient, double floor,
                      std::span<const Opening> openings);

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
