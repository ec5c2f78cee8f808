#include "air_leak.h"

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

struct Flow {
  double value;  // m3/s
  double slope;  // m3/(s Pa)
};

Flow flow_through(std::span<const Opening> openings, double difference) {
  Flow flow{0, 0};
  for (const Opening& opening : openings) {
    const double excess = difference - opening.threshold;
    if (excess <= 0) continue;
    flow.value += opening.conductance * excess;
    flow.slope += opening.conductance;
  }
  return flow;
}

}  // namespace

double air_after_leak(double air, double volume, double dt, double ambient, double floor,
                      std::span<const Opening> openings) {
  const double start = std::max(air / volume, floor);
  const double sign = start < ambient ? 1.0 : -1.0;
  if (start == ambient || flow_through(openings, std::abs(ambient - start)).value == 0) return air;
  // r(d) = 0 for the pressure difference d left after the step, 0 <= d <= d0: what entered is what flowed.
  // r grows with d and is convex, so that Newton's steps from d0 come down to the root without passing it.
  double difference = std::abs(ambient - start);
  for (int i = 0; i < 50; ++i) {
    const double pressure = ambient - sign * difference;
    const Flow flow = flow_through(openings, difference);
    const double upstream = std::max(pressure, ambient);
    const double residual =
        sign * (pressure * volume - std::max(air, floor * volume)) - dt * upstream * flow.value;
    double slope = -volume - dt * upstream * flow.slope;
    if (sign < 0) slope -= dt * flow.value;
    const double next = std::clamp(difference - residual / slope, 0.0, difference);
    if (difference - next <= 1e-15 * ambient) break;
    difference = next;
  }
  const double moved = volume * (ambient - sign * difference) - std::max(air, floor * volume);
  return air + moved;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
