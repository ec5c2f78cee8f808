#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/worlds.h"

// What slides on a slope, against Coulomb's law: friction holds at 0.99 of the angle of friction and lets go
// at 1.01 of it.
namespace softpoint {

inline constexpr double kFriction = 0.5;
inline constexpr double kDrift = 1e-4;  // m/s at rest
inline constexpr double kStiff = 1e7;   // Pa
inline constexpr double kLaw = 0.06;    // of the acceleration by Coulomb's law, 1 % above the angle
inline constexpr double kGravity = 9.81;

// Mean acceleration (m/s^2) by the law on a slope.
inline double by_law(double angle) { return kGravity * (std::sin(angle) - kFriction * std::cos(angle)); }

struct Motion {
  double drift = 0;         // m/s along the slope, mean over the last part
  double acceleration = 0;  // m/s^2, likewise
};

// Steps until things have settled, then measures what `place` (m) and `speed` (m/s) tell.
template <class Place, class Speed>
Motion measure(TestWorld& world, Place place, Speed speed) {
  constexpr int kSettle = 60, kWatched = 60;
  world.step(kSettle);
  const double x = place(), v = speed();
  world.step(kWatched);
  return {(place() - x) * 60 / kWatched, (speed() - v) * 60 / kWatched};
}

// `slide(angle)` gives the Motion on a slope of that angle (rad).
template <class Slide>
void judge_slope(const std::string& name, Slide slide) {
  const double angle = std::atan(kFriction);
  const Motion below = slide(0.99 * angle), above = slide(1.01 * angle);
  const double law = by_law(1.01 * angle);
  std::printf("    %-24s below: drift %8.1e m/s; above: %5.3f of the law\n", name.c_str(), below.drift,
              above.acceleration / law);
  EXPECT_LE(std::abs(below.drift), kDrift);
  EXPECT_NEAR(above.acceleration / law, 1.0, kLaw);
}

}  // namespace softpoint
