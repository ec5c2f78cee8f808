#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/precision.h"

// Bars of the matrix tests and what is measured against them.
namespace softpoint {

inline constexpr double kDepth = 1e-3;  // m
inline constexpr double kSoft = 1e5;    // Pa
// Change of the vertical speed in a step, as height (m): free fall has g dt^2 = 2.7 mm.
inline constexpr double kSmooth = 2.7e-3;
// Part of linear and of angular momentum that a step may lose or gain.
inline constexpr double kMomentum = by_precision(1e-13, 1e-6);

// The deepest penetration (m) over the frames of a run.
struct Watch {
  double deepest = -1;
  int frame = 0, in_contact = 0;
  void see(double depth, int now, const DeformableSystem& system) {
    if (depth > deepest) deepest = depth, frame = now;
    in_contact += !system.contacts().empty();
  }
  void judge(const std::string& name, const DeformableSystem& system) const {
    std::printf("    %-24s deepest %7.3f mm (frame %d), %d frames in contact\n", name.c_str(), 1e3 * deepest,
                frame, in_contact);
    EXPECT_LE(deepest, kDepth) << "frame " << frame;
    EXPECT_GT(in_contact, 5);
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
    EXPECT_EQ(system.profile().totals.late_substeps, 0);
    EXPECT_EQ(system.profile().counts.pairs_skipped, 0);
  }
};

// Heights of a centre over the frames.
struct Track {
  std::vector<double> heights;
  // Largest second difference from frame `begin` on (m).
  double jolt(std::size_t begin, std::size_t& when) const {
    double worst = 0;
    for (std::size_t i = begin + 1; i + 1 < heights.size(); ++i) {
      const double change = std::abs(heights[i + 1] - 2 * heights[i] + heights[i - 1]);
      if (change > worst) worst = change, when = i;
    }
    return worst;
  }
  void judge(const std::string& name, double way) const {
    std::size_t when = 0;
    const double worst = jolt(12, when);
    std::printf("    %-24s largest jolt %6.3f mm (frame %d), rolled %.3f m\n", name.c_str(), 1e3 * worst,
                static_cast<int>(when), way);
    EXPECT_LE(worst, kSmooth) << "frame " << when;
  }
};

// The ways in which things fall: turned, beside the middle, at 1 to 2 m/s. The first is drawn in hand, others
// by a fixed sequence.
struct Fall {
  Vec3 axis = Vec3(1, 0.5, -0.7), beside = Vec3(0.03, 0, -0.02);
  double angle = 0.4, speed = 1.5;
};

inline std::vector<Fall> falls() {
  std::vector<Fall> all(1);
  std::mt19937 sequence(7);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(sequence()) / 4294967295.0;
  };
  const int count = full_tier() ? 24 : 4;
  while (static_cast<int>(all.size()) < count) {
    Fall fall;
    fall.axis = Vec3(draw(-1, 1), draw(-1, 1), draw(-1, 1));
    fall.beside = Vec3(draw(-0.06, 0.06), 0, draw(-0.06, 0.06));
    fall.angle = draw(0, 3);
    fall.speed = draw(1, 2);
    all.push_back(fall);
  }
  return all;
}

}  // namespace softpoint
