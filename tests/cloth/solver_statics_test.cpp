// The solver at rest: answers known on paper.
#include <gtest/gtest.h>

#include <cmath>

#include "cloth_solver.h"

namespace {

using namespace softpoint;
using namespace softpoint::cloth;

// A strip of width w and length L under its own weight: rho g L^2/(2 E h), with E h = 4 k/3 free to contract.
TEST(ClothStatics, HangingStripStretches) {
  Fabric fabric;
  fabric.shear_stiffness = fabric.warp_stiffness / 2;
  fabric.compression_ratio = 1;
  fabric.area_density = 100;
  fabric.drag_rate = 20;
  fabric.damping_time = 1e-2;
  const double width = 0.1, length = 1;
  ClothPattern pattern = square_pattern(11, 101, width, length, fabric);
  for (Spring& spring : pattern.springs) {  // those of the border stand for half a cell
    if (spring.b - spring.a == 11 && (spring.a % 11 == 0 || spring.a % 11 == 10)) spring.stiffness /= 2;
  }
  ClothSettings settings;
  settings.precision = Precision::kDouble;
  settings.sweeps = 20;
  ClothSolver solver(pattern, fabric, settings);
  solver.set_gravity({0, -9.8, 0});
  std::vector<ClothHand> hands;
  for (int i = 0; i < 11; ++i) {
    ClothHand hand;
    hand.point = 100 * 11 + i;
    hand.target = pattern.points[hand.point];
    hands.push_back(hand);
  }
  solver.set_hands(hands);
  for (int frame = 0; frame < 60; ++frame) solver.step(1. / 60);
  const double membrane = 4. / 3 * fabric.warp_stiffness;
  const double expected = fabric.area_density * 9.8 * length * length / (2 * membrane);
  EXPECT_NEAR(pattern.points[5].y() - solver.position(5).y(), expected,
              0.025 * expected);  // held ends do not contract
  double force = 0;
  for (int i = 0; i < 11; ++i) force += solver.hand_force(i).y();
  const double weight = fabric.area_density * width * length * 9.8;
  EXPECT_NEAR(force, weight, 1e-3 * weight);
}

// mu = 0.4 is 21.80 degrees.
TEST(ClothStatics, InclineHoldsBelowItsAngleAndSlidesAbove) {
  Fabric fabric;
  fabric.drag_rate = 0;
  const ClothPattern pattern = square_pattern(12, 12, 0.1, 0.1, fabric);
  for (Precision precision : {Precision::kSingle, Precision::kDouble}) {
    for (double degrees : {21.6, 22.0}) {
      ClothSettings settings;
      settings.precision = precision;
      ClothSolver solver(pattern, fabric, settings);
      const double angle = degrees * M_PI / 180;
      solver.set_gravity({9.8 * std::sin(angle), 0, -9.8 * std::cos(angle)});
      std::vector<PointContacts> contacts(pattern.points.size());
      for (PointContacts& c : contacts) c.count = 1, c.planes[0].friction = 0.4;
      solver.set_contacts(contacts);
      for (int frame = 0; frame < 120; ++frame) solver.step(1. / 60);
      double farthest = 0, nearest = 1;
      for (int p = 0; p < pattern.point_count(); ++p) {
        const double way = solver.position(p).x() - pattern.points[p].x();
        farthest = std::max(farthest, std::abs(way));
        nearest = std::min(nearest, way);
      }
      if (degrees < 21.8) {
        EXPECT_LT(farthest, precision == Precision::kDouble ? 1e-6 : 5e-3);  // rounding makes single creep
      } else {
        const double expected = 0.5 * 9.8 * (std::sin(angle) - 0.4 * std::cos(angle)) * 4;
        EXPECT_NEAR(nearest, expected, 0.15 * expected);
      }
    }
  }
}

}  // namespace
