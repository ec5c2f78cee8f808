// Splines go through their points, are C2, and come to smooth motion with the order of cubics.
#include "softpoint/figure/spline.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "softpoint/core/error.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

std::vector<double> uneven_times(int count, double end) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i)
    times.push_back(end * (i + 0.3 * std::sin(2.0 * i) * (i > 0 && i + 1 < count)) / (count - 1));
  return times;
}

TEST(CubicSpline, ReproducesCubicsExactlyAndIsContinuousToTheSecondDerivative) {
  const auto cubic = [](double t) { return 1 - 2 * t + 0.5 * t * t + 0.7 * t * t * t; };
  std::vector<double> times = uneven_times(7, 3), values, odd;
  for (const double t : times) {
    values.push_back(cubic(t));
    odd.push_back(std::sin(5 * t));
  }
  const CubicSpline exact(times, values);
  for (double t = -0.2; t < 3.2; t += 0.01) {  // goes on beyond its ends
    EXPECT_NEAR(exact.at(t).value, cubic(t), 1e-12);
    EXPECT_NEAR(exact.at(t).rate, -2 + t + 2.1 * t * t, 1e-12);
    EXPECT_NEAR(exact.at(t).acceleration, 1 + 4.2 * t, 2e-11);
  }
  const CubicSpline open(times, odd),
      held(times, odd, {.rate = 4.0, .natural = false}, {.rate = {}, .natural = true});
  for (const CubicSpline* spline : {&open, &held}) {
    for (std::size_t i = 1; i + 1 < times.size(); ++i) {
      const SplinePoint a = spline->at(std::nextafter(times[i], -1)), b = spline->at(times[i]);
      EXPECT_NEAR(b.value, odd[i], 1e-14);
      EXPECT_NEAR(a.rate, b.rate, 1e-12);
      EXPECT_NEAR(a.acceleration, b.acceleration, 1e-10);
    }
  }
  EXPECT_NEAR(held.at(0).rate, 4, 1e-13);
  EXPECT_NEAR(held.at(3).acceleration, 0, 1e-11);
  EXPECT_NEAR(CubicSpline({0, 2}, {1, 5}).at(0.5).value, 2, 1e-15);
  EXPECT_NEAR(CubicSpline({0, 1, 3}, {0, 1, 9}).at(2).value, 4, 1e-14);
  EXPECT_NEAR(CubicSpline({0, 1}, {0, 1}, {.rate = 0.0, .natural = false}).at(0.5).value, 0.25, 1e-15);
}

TEST(CubicSpline, ComesToSmoothMotionWithOrderFour) {
  const auto error = [](int count) {
    std::vector<double> times, values;
    for (int i = 0; i < count; ++i) {
      times.push_back(2.0 * i / (count - 1));
      values.push_back(std::sin(3 * times.back() + 0.4));
    }
    const CubicSpline spline(times, values);
    double worst = 0;
    for (double t = 0; t <= 2; t += 0.001)
      worst = std::max(worst, std::abs(spline.at(t).value - std::sin(3 * t + 0.4)));
    return worst;
  };
  EXPECT_NEAR(std::log2(error(41) / error(81)), 4, 0.3);
}

// A turn that tumbles: its angular velocity and acceleration by differences.
Eigen::Quaterniond tumbling(double t) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(1.3 * std::sin(2 * t), Vec3::UnitX())) *
         Eigen::Quaterniond(Eigen::AngleAxisd(2.1 * t, Vec3(1, 2, -1).normalized())) *
         Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * std::cos(3 * t), Vec3::UnitZ()));
}

TurnSpline tumbling_spline(int count) {
  std::vector<double> times;
  std::vector<std::array<double, 4>> turns;
  for (int i = 0; i < count; ++i) {
    times.push_back(2.0 * i / (count - 1));
    const Eigen::Quaterniond q = tumbling(times.back());
    const double sign = i % 3 == 0 ? -2.0 : 1.0;  // sign and length of a quaternion mean nothing
    turns.push_back({sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()});
  }
  return {times, turns};
}

Eigen::Quaterniond turn_of(const TurnSplinePoint& p) { return {p.turn[0], p.turn[1], p.turn[2], p.turn[3]}; }

TEST(TurnSpline, GoesThroughItsTurnsWithContinuousSpinAndItsChange) {
  const TurnSpline spline = tumbling_spline(11);
  for (int i = 0; i < 11; ++i) {
    EXPECT_LE(turn_of(spline.at(0.2 * i)).angularDistance(tumbling(0.2 * i)), 1e-7);
    const double t = 0.2 * i, e = 1e-9;
    if (i == 0 || i == 10) continue;
    EXPECT_LE((spline.at(t - e).spin - spline.at(t + e).spin).norm(), 1e-6);
    EXPECT_LE((spline.at(t - e).spin_change - spline.at(t + e).spin_change).norm(), 1e-4);
  }
  // Spin and change are the derivatives of the turn, everywhere: central differences.
  double spin = 0, change = 0;
  for (double t = 0.0013; t < 1.99; t += 0.0371) {
    const double e = 1e-5;
    const TurnSplinePoint a = spline.at(t - e), b = spline.at(t + e), m = spline.at(t);
    Eigen::Quaterniond d = turn_of(a).conjugate() * turn_of(b);
    if (d.w() < 0) d.coeffs() = -d.coeffs();
    spin = std::max(spin, (2 * d.vec() / (2 * e) - m.spin).norm() / (1 + m.spin.norm()));
    if (std::abs(std::remainder(t, 0.2)) > 2 * e) {
      change =
          std::max(change, ((b.spin - a.spin) / (2 * e) - m.spin_change).norm() / (1 + m.spin_change.norm()));
    }
  }
  EXPECT_LE(spin, 1e-8);
  EXPECT_LE(change, 1e-8);
}

TEST(TurnSpline, ComesToSmoothMotionWithOrderFour) {
  const auto error = [](int count) {
    const TurnSpline spline = tumbling_spline(count);
    double worst = 0;
    for (double t = 0; t <= 2; t += 0.003) {
      const Eigen::Quaterniond d = turn_of(spline.at(t)).conjugate() * tumbling(t);
      worst = std::max(worst, 2 * d.vec().norm());
    }
    return worst;
  };
  const double coarse = error(41), fine = error(81);
  std::printf("    %.1e to %.1e rad\n", coarse, fine);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.35);
}

TEST(TurnSpline, AboutOneAxisItIsTheCubicSpline) {
  std::vector<double> times = uneven_times(8, 2), angles;
  std::vector<std::array<double, 4>> turns;
  for (const double t : times) {
    angles.push_back(0.9 * std::sin(3 * t));
    turns.push_back({std::cos(angles.back() / 2), 0, std::sin(angles.back() / 2), 0});
  }
  const CubicSpline plain(times, angles, {.rate = 1.0, .natural = false}, {.rate = -0.5, .natural = false});
  const TurnSpline spline(times, turns, {Vec3(0, 1, 0)}, {Vec3(0, -0.5, 0)});
  for (double t = 0; t < 2; t += 0.01) {
    EXPECT_NEAR(2 * std::atan2(spline.at(t).turn[2], spline.at(t).turn[0]), plain.at(t).value, 1e-13);
    EXPECT_NEAR(spline.at(t).spin.y(), plain.at(t).rate, 1e-12);
    EXPECT_NEAR(spline.at(t).spin_change.y(), plain.at(t).acceleration, 1e-11);
  }
}

TEST(Splines, RefuseWhatMakesNone) {
  expect_refusal([] { CubicSpline({0}, {1}); }, {"spline times", "at least 2"});
  expect_refusal([] { CubicSpline({0, 1}, {1}); }, {"spline values: 1", "permitted are 2"});
  expect_refusal([] { CubicSpline({0, 1, 1}, {1, 2, 3}); }, {"spline time 2 = 1", "increase"});
  expect_refusal(
      [] {
        CubicSpline({0, 1}, {1, std::numeric_limits<double>::quiet_NaN()});
      },
      {"spline value 1"});
  expect_refusal([] { TurnSpline({0, 1}, {{1, 0, 0, 0}, {0, 0, 0, 0}}); }, {"spline turn 1", "length"});
}

}  // namespace
}  // namespace softpoint::figure
