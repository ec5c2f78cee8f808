// Cloth as a body of a Bullet world: contact, hands, sleep, snapshots, refusals.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include "cloth_scene.h"
#include "support/precision.h"
#include "support/refusal.h"

namespace softpoint::cloth {
namespace {

TEST(ClothBody, LiesOnAFloorWithItsWeight) {
  OverFloor scene;
  scene.world.step(30);
  const double weight = scene.cloth.total_mass() * 9.81;
  EXPECT_NEAR(sum(scene.cloth.contact_forces()).y(), weight, 0.01 * weight);
  EXPECT_NEAR(lowest(scene.cloth), 0.5 * scene.cloth.fabric().thickness, 1e-6);
  EXPECT_LT(scene.cloth.stretch().largest, 1e-4);
  EXPECT_EQ(scene.cloth.guard_fired(), 0);
  // Core tells of it as of one force.
  ASSERT_EQ(scene.system.contacts().size(), 1u);
  EXPECT_EQ(scene.system.contacts()[0].other, &scene.floor);
  EXPECT_NEAR(scene.system.contacts()[0].force.y(), weight, 0.01 * weight);
  EXPECT_NEAR(scene.cloth.contact_area(), 0.09, 1e-6);
}

TEST(ClothBody, DryClothPaysNothingForAirAndFlatClothNothingForItself) {
  ClothDesign design = sheet();
  design.self_contact.on = true;
  OverFloor scene(design);
  scene.world.step(5);
  for (int i = 0; i < 20; ++i) {
    scene.world.step();
    EXPECT_TRUE(scene.cloth.profile().counts.air_skipped);
    EXPECT_TRUE(scene.cloth.profile().counts.self_skipped);
    EXPECT_EQ(scene.cloth.profile().counts.pockets, 0);
  }
}

TEST(ClothBody, HandsHoldDragReleaseAndAreRead) {
  OverFloor scene(sheet(), 0.5);
  const int corner = 0, other = 14;
  const Vec3 a = scene.cloth.points()[corner], b = scene.cloth.points()[other];
  const HandleId pin = scene.system.grab(scene.cloth, corner, a);
  const HandleId hand = scene.system.grab(scene.cloth, other, b);
  scene.world.step(60);
  EXPECT_GT(scene.system.handle_force(pin).y() + scene.system.handle_force(hand).y(), 0.0);
  EXPECT_LT((scene.cloth.points()[corner] - a).norm(), 1e-6);
  for (int i = 1; i <= 30; ++i) {
    scene.system.move(hand, b + Vec3(0, 0.005 * i, 0));
    scene.world.step();
    EXPECT_LT((scene.cloth.points()[other] - b - Vec3(0, 0.005 * i, 0)).norm(), 1e-6) << i;
  }
  scene.system.release(hand);
  scene.world.step(20);
  EXPECT_GT((scene.cloth.points()[other] - b - Vec3(0, 0.15, 0)).norm(), 0.01);  // it is free
  EXPECT_LT((scene.cloth.points()[corner] - a).norm(), 1e-6);
}

// What a bubble's volume changes by when the cloth rises over its feet, which stand under `before`, m2: the
// area that the faces cover, and that of the bilinear patches down to the feet, weighted by how much of the
// way they go.
double lifted_area(const Cloth& cloth, std::span<const Vec3> before) {
  const auto points = cloth.points();
  std::set<std::pair<int, int>> sides;
  double area = 0;
  for (const auto& [a, b, c] : cloth.faces()) {
    area += (points[b] - points[a]).cross(points[c] - points[a]).y() / 2;
    for (const auto& side : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) sides.insert(side);
  }
  for (const auto& [a, b] : sides) {
    if (sides.contains({b, a})) continue;
    const Vec3 edge = points[a] - points[b], foot = before[a] - before[b];
    const Vec3 down = (before[a] - points[a] + before[b] - points[b]) / 2;
    area += (edge / 3 + foot / 6).cross(down).y();
  }
  return area;
}

// The thesis' one bubble under a lifted sheet: what the floor gets of the suction is the opposite of what the
// cloth gets, its gauge pressure times the change of its volume.
TEST(ClothBody, SuctionOnTheFloorIsOppositeToThatOnTheCloth) {
  ClothDesign design = sheet();
  design.saturation.assign(design.pattern.points.size(), 1.0);
  design.air = thesis_air(1e-4);
  OverFloor scene(design);
  const int middle = 7 * 15 + 7;
  const Vec3 start = scene.cloth.points()[middle];
  const HandleId hand = scene.system.grab(scene.cloth, middle, start, 30.0);
  double largest = 0, worst = 0;
  for (int i = 1; i <= 40; ++i) {
    const std::vector<Vec3> before(scene.cloth.points().begin(), scene.cloth.points().end());
    scene.system.move(hand, start + Vec3(0, 0.001 * i, 0));
    scene.world.step();
    ASSERT_EQ(scene.cloth.bubbles().size(), 1u);
    ASSERT_EQ(scene.system.contacts().size(), 1u);
    const double gauge = scene.cloth.bubbles()[0].pressure - scene.cloth.air().ambient;
    const double on_cloth = gauge * lifted_area(scene.cloth, before);
    const double on_floor = -(scene.system.contacts()[0].force - sum(scene.cloth.contact_forces())).y();
    largest = std::max(largest, std::abs(on_cloth));
    worst = std::max(worst, std::abs(on_floor + on_cloth));
  }
  std::printf("    suction to %.0f N, differs by %.1e N\n", largest, worst);
  EXPECT_GT(largest, 1.0);
  EXPECT_LT(worst, by_precision(1e-9, 1e-4) * largest);
}

TEST(ClothBody, SleepsCostsNothingAndWakes) {
  OverFloor scene;
  for (int i = 0; i < 300 && !scene.cloth.asleep(); ++i) {
    scene.world.step();
  }
  ASSERT_TRUE(scene.cloth.asleep());
  const int substeps = scene.cloth.profile().counts.substeps;
  EXPECT_GT(substeps, 0);
  const auto wakes = [&](auto&& rouse) {
    rouse();
    scene.world.step(2);
    const bool awake = !scene.cloth.asleep();
    for (int i = 0; i < 300 && !scene.cloth.asleep(); ++i) {
      scene.world.step();
    }
    EXPECT_TRUE(scene.cloth.asleep());
    return awake;
  };
  EXPECT_TRUE(wakes([&] { scene.cloth.set_wind(Vec3(0.01, 0, 0)); }));
  EXPECT_TRUE(wakes([&] { scene.cloth.set_self_contact({true, 0.2}); }));
  EXPECT_TRUE(wakes([&] { scene.cloth.set_settings(settings_of(Dial::kFast)); }));
  HandleId hand = 0;
  EXPECT_TRUE(wakes([&] { hand = scene.system.grab(scene.cloth, 7, scene.cloth.points()[7]); }));
  EXPECT_TRUE(wakes([&] { scene.system.move(hand, scene.cloth.points()[7] + Vec3(0, 0.01, 0)); }));
  EXPECT_TRUE(wakes([&] { scene.system.release(hand); }));
}

// By the processor's clock, and by what the profile counts.
TEST(ClothBody, ASleepingClothCostsLessThanAHundredthOfAMovingOne) {
  ClothDesign design = sheet(30);
  design.saturation.assign(design.pattern.points.size(), 1.0);
  OverFloor scene(design, 0.02);
  const auto step_seconds = [&](int count) {
    std::vector<double> seconds;
    for (int i = 0; i < count; ++i) {
      const std::clock_t start = std::clock();
      for (int k = 0; k < 10; ++k) scene.world.step();
      seconds.push_back(double(std::clock() - start) / CLOCKS_PER_SEC / 10);
    }
    std::nth_element(seconds.begin(), seconds.begin() + count / 2, seconds.end());
    return seconds[static_cast<std::size_t>(count / 2)];
  };
  const double moving = step_seconds(3);
  for (int i = 0; i < 1200 && !scene.cloth.asleep(); ++i) scene.world.step();
  scene.world.step();
  ASSERT_TRUE(scene.cloth.asleep());
  const std::vector<Vec3> before(scene.cloth.points().begin(), scene.cloth.points().end());
  const double asleep = step_seconds(51);
  std::printf("    asleep %.2f us, moving %.2f us\n", 1e6 * asleep, 1e6 * moving);
  EXPECT_LT(asleep, 0.01 * moving);
  EXPECT_EQ(scene.system.profile().counts.sleeping, 1);
  EXPECT_EQ(scene.system.profile().seconds.total(), 0.0);
  EXPECT_TRUE(std::equal(before.begin(), before.end(), scene.cloth.points().begin()));
}

// Tied to two points on one side of the body, which hangs on the cloth: lighter than a fifth of the cloth to
// twenty times as heavy.
TEST(ClothBody, ABodyTiedToItHangsOnIt) {
  for (const double part : {0.2, 2.0, 20.0}) {
    OverFloor scene(sheet(20, 0.2), 0.5);
    const double mass = part * scene.cloth.total_mass();
    btRigidBody& box = scene.world.add_box(Vec3(0.02, 0.02, 0.02), mass, Vec3(0, 0.52, 0.11));
    for (const std::size_t p : {380, 385, 390, 395, 399}) {
      scene.system.grab(scene.cloth, static_cast<int>(p), scene.cloth.points()[p]);
    }
    const HandleId ties[] = {scene.system.attach(scene.cloth, 9, box),
                             scene.system.attach(scene.cloth, 10, box)};
    const auto distance = [&](std::size_t point) {
      const btVector3 at = box.getWorldTransform().getOrigin();
      return (scene.cloth.points()[point] - Vec3(at.x(), at.y(), at.z())).norm();
    };
    const double before[] = {distance(9), distance(10)};
    scene.world.step(240);
    double pull = 0, apart = 0;
    for (int i = 0; i < 60; ++i) {
      scene.world.step();
      for (int k = 0; k < 2; ++k) {
        pull -= scene.system.handle_force(ties[k]).y() / 60;
        apart = std::max(apart, std::abs(distance(static_cast<std::size_t>(9 + k)) - before[k]));
      }
    }
    std::printf("    %.1f of the cloth: pulls with %.4f of its weight, ties %.1e m apart, stretch %.4f\n",
                part, pull / (9.81 * mass), apart, scene.cloth.stretch().largest);
    EXPECT_NEAR(pull, 9.81 * mass, 0.1 * 9.81 * mass) << part;
    EXPECT_LT(apart, 1e-4) << part;
    EXPECT_EQ(scene.cloth.guard_fired(), 0) << part;
  }
}

TEST(ClothBody, ASnapshotGoesOnWithTheSameBits) {
  OverFloor scene(sheet(), 0.1);
  const HandleId hand = scene.system.grab(scene.cloth, 7, scene.cloth.points()[7], 5.0);
  scene.world.step(20);
  const auto run = [&] {
    std::vector<Vec3> all;
    for (int i = 0; i < 40; ++i) {
      scene.system.move(hand, Vec3(0, 0.1 + 0.002 * i, 0.15));
      scene.world.step();
      all.insert(all.end(), scene.cloth.points().begin(), scene.cloth.points().end());
    }
    return all;
  };
  const Snapshot snapshot = scene.system.save();
  const std::vector<Vec3> first = run();
  scene.system.restore(snapshot);
  EXPECT_EQ(run(), first);
}

// Where a wet sheet, lifted over its bubbles, is after `to` frames; saved at `from`, and played from there
// `times` times.
std::vector<Vec3> lifted(const ClothDesign& design, int from, int to, int times) {
  OverFloor scene(design);
  const int middle = static_cast<int>(design.pattern.points.size()) / 2;
  const Vec3 start = scene.cloth.points()[static_cast<std::size_t>(middle)];
  const HandleId hand = scene.system.grab(scene.cloth, middle, start);
  const auto play = [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      scene.system.move(hand, start + Vec3(0, 0.001 * i, 0));
      scene.world.step();
    }
  };
  play(0, from);
  const Snapshot snapshot = scene.system.save();
  for (int k = 0; k < times; ++k) {
    scene.system.restore(snapshot);
    scene.system.flush_contact_caches();
    play(from, to);
  }
  return {scene.cloth.points().begin(), scene.cloth.points().end()};
}

TEST(ClothBody, ASnapshotOverBubblesGoesOnWithTheSameBits) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    ClothDesign design = sheet(20);
    design.saturation.assign(design.pattern.points.size(), 1.0);
    design.air.initial_volume = 2e-4;
    design.solver.precision = precision;
    EXPECT_TRUE(lifted(design, 25, 35, 1) == lifted(design, 25, 35, 2));
  }
}

TEST(ClothBody, ASnapshotBetweenExplicitStepsGoesOnWithTheSameBits) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    ClothDesign design = sheet(50);
    design.saturation.assign(design.pattern.points.size(), 1.0);
    design.air = thesis_air(4e-4);
    design.solver.precision = precision;
    const std::vector<Vec3> end = lifted(design, 12, 18, 1);
    EXPECT_TRUE(lifted(design, 12, 18, 2) == end);
    design.solver.march_step = 0;
    EXPECT_FALSE(lifted(design, 12, 18, 1) == end);  // it was by explicit steps
  }
}

TEST(ClothBody, RefusesWhatItCannotBe) {
  ClothDesign design = sheet();
  const auto make = [&] { Cloth cloth(design); };
  design.saturation.assign(3, 0.5);
  expect_refusal(make, {"saturation", "3", "225"});
  design.saturation.assign(225, 0.5);
  design.saturation[7] = 1.5;
  expect_refusal(make, {"saturation of point 7", "1.5"});
  design.saturation.clear();
  design.start.assign(2, Vec3::Zero());
  expect_refusal(make, {"start", "2", "225"});
  design.start.clear();
  design.self_contact.friction = -1;
  expect_refusal(make, {"self_contact.friction", "-1"});
  design.self_contact.friction = 0.3;
  EXPECT_THROW(Cloth(design, Vec3(1e9, 0, 0)), Error);
  EXPECT_THROW(Cloth(design, Vec3::Zero(), 2.0 * Mat3::Identity()), Error);

  OverFloor scene;
  scene.cloth.set_wind(Vec3(1, 2, 3));
  expect_refusal([&] { scene.cloth.set_wind(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0)); },
                 {"set_wind", "nan"});
  EXPECT_EQ(scene.cloth.wind(), Vec3(1, 2, 3));
  std::vector<double> saturation(225, 0.25);
  scene.cloth.set_saturation(saturation);
  const double mass = scene.cloth.total_mass();
  saturation[3] = -0.1;
  expect_refusal([&] { scene.cloth.set_saturation(saturation); }, {"saturation of point 3", "-0.1"});
  EXPECT_EQ(scene.cloth.saturation()[3], 0.25);
  EXPECT_EQ(scene.cloth.total_mass(), mass);
  expect_refusal([&] { scene.cloth.set_self_contact({true, 1e6}); }, {"self_contact.friction"});
  EXPECT_EQ(scene.cloth.self_contact().friction, SelfContact().friction);
  EXPECT_THROW(scene.cloth.set_velocity(Vec3(1e9, 0, 0)), Error);
}

TEST(ClothBody, WaterMakesItHeavier) {
  OverFloor scene;
  const double dry = scene.cloth.total_mass();
  scene.cloth.set_saturation(std::vector<double>(225, 1.0));
  EXPECT_NEAR(scene.cloth.total_mass(), dry * (1.0 + scene.cloth.wetness().capacity), 1e-12);
  EXPECT_NEAR(double(scene.cloth.m_nodes[5].m_im) * scene.cloth.masses()[5], 1.0, 1e-6);
}

}  // namespace
}  // namespace softpoint::cloth
