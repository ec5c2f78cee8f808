// Bubbles under a cloth that moves: the search and the solver together, over the plane z = 0.
#include <gtest/gtest.h>

#include <cmath>

#include "air_sheet.h"
#include "cloth_solver.h"

namespace softpoint::cloth {
namespace {

constexpr double kGravity = 9.8;

// As by default, but no air comes or goes.
AirSettings tight() {
  AirSettings settings;
  settings.leak = settings.vent = false;
  return settings;
}

// A wet sheet with slack in two places, at rest on the plane.
struct TwoBubbles {
  explicit TwoBubbles(const AirSettings& settings, double left = 0.02, double right = 0.012)
      : pattern(square_pattern(41, 31, 0.4, 0.3, Fabric{})), finder(topology(left, right), settings) {
    ClothSettings dial;
    dial.precision = Precision::kDouble;
    solver = std::make_unique<ClothSolver>(pattern, Fabric{}, dial);
    positions = pattern.points;
    solver->set_gravity({0, 0, -kGravity});
    const std::size_t count = positions.size();
    feet.resize(count);
    normals.assign(count, Vec3::UnitZ());
    gaps.resize(count);
    contacts.resize(count);
    finder.set_saturation(std::vector<double>(count, 1.0));
    for (const double m : pattern.masses) mass += m;
  }

  AirTopology topology(double left, double right) {
    for (Vec3& x : pattern.points) {
      x.z() = bump(x.x() + 0.1, x.y(), left, 0.07) + bump(x.x() - 0.1, x.y(), right, 0.07);
    }
    for (Spring& spring : pattern.springs) {
      spring.rest = (pattern.points[spring.a] - pattern.points[spring.b]).norm();
    }
    return make_air_topology(pattern.points, pattern.faces);
  }

  void step(double dt = 1.0 / 60) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      feet[i] = Vec3(positions[i].x(), positions[i].y(), 0);
      gaps[i] = std::max(positions[i].z(), 0.0);
      contacts[i].count = 1;
      contacts[i].planes[0].foot = feet[i];
      contacts[i].planes[0].friction = 0.4;
    }
    finder.find({positions, feet, normals, gaps});
    for (std::size_t i = 0; i < positions.size(); ++i) contacts[i].planes[0].adhesion = finder.adhesion()[i];
    solver->set_contacts(contacts);
    solver->set_air(finder.face_pockets(), finder.pockets(), finder.rims());
    solver->set_hands(hands);
    solver->step(dt);
    solver->positions(positions);
    std::vector<double> volumes;
    for (const PocketState& state : solver->pockets()) volumes.push_back(state.volume);
    for (std::size_t i = 0; i < volumes.size(); ++i) {
      if (finder.pockets()[i].open) continue;
      EXPECT_NEAR(volumes[i], finder.volume(static_cast<int>(i), positions), 1e-9) << i;
    }
    finder.exchange(dt, volumes);
    EXPECT_LE(std::abs(finder.audit()), 1e-9 * std::max(finder.initial_air(), 1.0));
  }

  double gauge(int pocket) const { return solver->pockets()[pocket].gauge; }
  int count() const {
    int bubbles = 0;
    for (const Bubble& bubble : finder.bubbles()) bubbles += !bubble.patch;
    return bubbles;
  }
  double highest() const {
    double z = 0;
    for (const Vec3& x : positions) z = std::max(z, x.z());
    return z;
  }

  ClothPattern pattern;
  BubbleFinder finder;
  std::unique_ptr<ClothSolver> solver;
  std::vector<Vec3> positions, feet, normals;
  std::vector<double> gaps;
  std::vector<PointContacts> contacts;
  std::vector<ClothHand> hands;
  double mass = 0;
};

TEST(BubblesInMotion, TwoCarryTheClothOverThem) {
  TwoBubbles cloth(tight());
  for (int frame = 0; frame < 120; ++frame) {
    cloth.step();
    ASSERT_LT(cloth.highest(), 0.03) << "frame " << frame;
  }
  ASSERT_EQ(cloth.count(), 2);
  EXPECT_EQ(cloth.finder.counts().merged, 0);
  const double weight = cloth.mass * kGravity / 0.12;  // Pa
  for (int i = 0; i < 2; ++i) {
    EXPECT_GT(cloth.gauge(i), 0.2 * weight);
    EXPECT_LT(cloth.gauge(i), 10 * weight);
  }
  EXPECT_LT(cloth.solver->kinetic_energy(), 1e-5);
}

TEST(BubblesInMotion, TwoMergeWhenTheStripBetweenThemIsLifted) {
  TwoBubbles cloth(tight());
  for (int frame = 0; frame < 30; ++frame) cloth.step();
  ASSERT_EQ(cloth.count(), 2);
  const double air = cloth.finder.pockets()[0].air + cloth.finder.pockets()[1].air;
  const int middle = 15 * 41 + 20;
  const Vec3 start = cloth.positions[middle];
  int merged_at = -1;
  for (int frame = 1; frame <= 60; ++frame) {
    const double s = frame / 60.0, smooth = s * s * (3 - 2 * s);
    ClothHand hand;
    hand.point = middle;
    hand.target = start + Vec3(0, 0, 0.015 * smooth);
    hand.max_force = 30;
    cloth.hands = {hand};
    cloth.step();
    if (merged_at < 0 && cloth.finder.counts().merged > 0) merged_at = frame;
  }
  EXPECT_GT(merged_at, 0);
  ASSERT_EQ(cloth.count(), 1);
  // All of it, and what burst in through the pores while the gap opened under the hand.
  const double burst = -cloth.finder.vented();
  EXPECT_GE(burst, 0);
  EXPECT_LT(burst, 0.01 * air);
  EXPECT_NEAR(cloth.finder.air(), air + burst, 1e-9 * air);
  EXPECT_LT(std::abs(cloth.gauge(0)), 200);
  EXPECT_LT(cloth.solver->kinetic_energy(), 1e-4);
  std::printf("[ merged   ] in frame %d of the lift, %.1f Pa over the atmosphere\n", merged_at,
              cloth.gauge(0));
}

}  // namespace
}  // namespace softpoint::cloth
