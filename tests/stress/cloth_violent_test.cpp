// Cloth handled as no hand would: whatever happens, numbers stay finite, points stay out of the floor, air is
// conserved, and what is let go lies down unstretched.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>

#include "../cloth/cloth_scene.h"
#include "support/precision.h"
#include "support/tier.h"

namespace softpoint::cloth {
namespace {

struct Trial {
  double speed = 1;      // m/s, of the hand
  double volume = 0;     // m3, of air to begin with
  double dt = 1.0 / 60;  // s
  double stiffness = 1e4;
  bool sideways = false;
  Precision precision = Precision::kSingle;

  std::string text() const {
    return std::to_string(speed) + " m/s " + (sideways ? "anywhere" : "up and down") + ", " +
           std::to_string(1e6 * volume) + " cm3, frames of " + std::to_string(dt) + " s, " +
           std::to_string(stiffness) + " N/m" + (precision == Precision::kDouble ? ", double" : "");
  }
};

struct Worst {
  double deepest = 0, stretch = 0, audit = 0, farthest = 0;
  long long steps = 0;

  void look(const Cloth& cloth) {
    ++steps;
    for (const Vec3& p : cloth.points()) {
      ASSERT_TRUE(p.allFinite());
      deepest = std::max(deepest, -p.y());
      farthest = std::max(farthest, p.norm());
    }
  }
};

constexpr double kSide = 0.3;  // m
constexpr int kPoints = 12;    // along a side

// Whether the springs can draw in against the friction of the film under one point: what they cannot, stays
// stretched for good, as it should.
bool overcomes_its_film(const ClothDesign& design) {
  const double spacing = kSide / (kPoints - 1);
  const double friction = 1.5 * film_pressure(design.air, 0) * spacing * spacing;
  return 0.02 * spacing * design.fabric.warp_stiffness > friction;
}

void play(const Trial& t, std::mt19937& random, int steps, Worst& worst) {
  SCOPED_TRACE(t.text());
  ClothDesign design;
  design.fabric.warp_stiffness = design.fabric.weft_stiffness = t.stiffness;
  design.fabric.shear_stiffness = t.stiffness / 4;
  design.pattern = square_pattern(kPoints, kPoints, kSide, kSide, design.fabric);
  design.saturation.assign(kPoints * kPoints, 1.0);
  design.air.initial_volume = t.volume;
  design.solver.precision = t.precision;
  OverFloor scene(design, 0.00015);
  scene.cloth.setActivationState(DISABLE_DEACTIVATION);
  const int middle = kPoints / 2 * kPoints + kPoints / 2;
  const Vec3 start = scene.cloth.points()[middle];
  const HandleId hand = scene.system.grab(scene.cloth, middle, start, 60.0);
  Vec3 target = start;
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < steps; ++i) {
    const Vec3 way =
        t.sideways ? Vec3(unit(random), unit(random), unit(random)) : Vec3(0, i < steps / 2 ? 1 : -1, 0);
    target += t.speed * t.dt * way;
    target = target.cwiseMax(Vec3(-1, 0.0002, -1)).cwiseMin(Vec3(1, 1.5, 1));
    scene.system.move(hand, target);
    scene.world.step(1, t.dt);
    ASSERT_NO_FATAL_FAILURE(worst.look(scene.cloth));
  }
  scene.system.release(hand);
  for (int i = 0; i < static_cast<int>(3.0 / t.dt) && i < 120; ++i) {
    scene.world.step(1, t.dt);
    ASSERT_NO_FATAL_FAILURE(worst.look(scene.cloth));
  }
  if (overcomes_its_film(design) && lowest(scene.cloth) < 0.01 && scene.cloth.max_speed() < 0.2) {
    worst.stretch = std::max(worst.stretch, scene.cloth.stretch().largest);
  }
  const AirBalance air = scene.cloth.air_balance();
  worst.audit = std::max(worst.audit, std::abs(air.audit) / std::max(air.initial, 1.0));
  EXPECT_EQ(scene.cloth.guard_fired(), 0);
}

TEST(ClothStress, ViolentHandlingStaysSound) {
  std::mt19937 random(5);
  const double speeds[] = {1, 10, 50}, volumes[] = {0, 4e-4, 4e-3},
               steps[] = {1.0 / 15, 1.0 / 60, 1.0 / 1000}, stiffnesses[] = {1e2, 1e4, 1e6};
  const int trials = by_tier(500, 60, 12), length = by_tier(200, 25, 15);
  Worst worst;
  for (int i = 0; i < trials && !HasFatalFailure(); ++i) {
    const auto pick = [&](const auto& list) {
      return list[std::uniform_int_distribution<std::size_t>(0, std::size(list) - 1)(random)];
    };
    Trial trial{pick(speeds),      pick(volumes), pick(steps),
                pick(stiffnesses), i % 2 == 1,    i % 4 < 2 ? Precision::kSingle : Precision::kDouble};
    play(trial, random, length, worst);
  }
  std::printf(
      "    %d trials, %lld steps: deepest %.3f mm, stretch at rest %.4f, audit %.1e, farthest %.0f m\n",
      trials, worst.steps, 1e3 * worst.deepest, worst.stretch, worst.audit, worst.farthest);
  EXPECT_LT(worst.deepest, 2e-4);
  EXPECT_LT(worst.stretch, 0.02);
  EXPECT_LT(worst.audit, 1e-9);
  EXPECT_LT(worst.farthest, 200);  // 60 N throw it at 90 m/s, for 2 s
}

}  // namespace
}  // namespace softpoint::cloth
