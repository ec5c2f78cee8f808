// Dragging: exact holds, limited pulls, pins, releases.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/penetration.h"
#include "support/precision.h"
#include "support/tier.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

TEST(Handle, HoldsItsPointExactly) {
  for (const double young : {1e4, 1e6, 1e9}) {
    TestWorld world;
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, young), Vec3(0, 2, 0));
    system.add(body);
    Vec3 target = body.points()[20];
    const HandleId handle = system.grab(body, 20, target);
    double worst = 0;
    for (int i = 0; i < 240; ++i) {
      target += Vec3(0.03 * std::sin(0.2 * i), 0.02 * std::cos(0.3 * i), i == 60 ? 0.5 : 0.01);
      system.move(handle, target);
      world.step();
      worst = std::max(worst, (body.points()[20] - target).norm());
    }
    EXPECT_LE(worst, 1e-6) << "E " << young;
  }
}

TEST(Handle, SeveralHoldTheirPointsExactly) {
  for (const double young : {1e5, 1e7, 1e9}) {
    TestWorld world;
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, young), Vec3(0, 2, 0));
    system.add(body);
    std::vector<int> held;
    std::vector<Vec3> targets;
    std::vector<HandleId> handles;
    for (int v = 0; v < 17; ++v) {  // the bottom cap and its centre
      held.push_back(v);
      targets.push_back(body.points()[static_cast<std::size_t>(v)]);
      handles.push_back(system.grab(body, v, targets.back()));
    }
    double worst = 0;
    for (int i = 0; i < 60; ++i) {
      for (std::size_t k = 0; k < held.size(); ++k) {
        targets[k] += Vec3(0.01, 0.02 * std::sin(0.1 * i), 0);
        system.move(handles[k], targets[k]);
      }
      world.step();
      for (std::size_t k = 0; k < held.size(); ++k) {
        worst = std::max(worst, (body.points()[static_cast<std::size_t>(held[k])] - targets[k]).norm());
      }
    }
    std::printf("    E %.0e, 17 handles: worst distance %.1e m\n", young, worst);
    EXPECT_LE(worst, 1e-6) << "E " << young;
  }
}

TEST(Handle, ForceOfAHangingBodyIsItsWeight) {
  for (const double young : {1e5, 1e7}) {
    TestWorld world;
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, young), Vec3(0, 2, 0));
    system.add(body);
    int top = 0;
    for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
      const auto at = [&](int i) { return body.points()[static_cast<std::size_t>(i)].sum(); };
      if (at(v) > at(top)) top = v;
    }
    const HandleId handle = system.grab(body, top, body.points()[static_cast<std::size_t>(top)]);
    Vec3 mean = Vec3::Zero();
    world.step(1200);
    for (int i = 0; i < 1200; ++i) {  // a pendulum hardly damped: its mean pull is what is known
      world.step();
      mean += system.handle_force(handle) / 1200;
    }
    EXPECT_NEAR(mean.y() / (9.81 * body.total_mass()), 1.0, 0.02);
  }
}

TEST(Handle, ForceOfAPinnedPlatformIsItsWeight) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  std::vector<HandleId> handles;
  for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
    if (body.points()[static_cast<std::size_t>(v)].y() > 2.19) {
      handles.push_back(system.grab(body, v, body.points()[static_cast<std::size_t>(v)]));
    }
  }
  world.step(300);
  Vec3 sum = Vec3::Zero();
  for (const HandleId h : handles) sum += system.handle_force(h);
  EXPECT_NEAR(sum.y() / (9.81 * body.total_mass()), 1.0, 1e-3);
  EXPECT_LT(std::hypot(sum.x(), sum.z()), 1e-3 * sum.y());
}

TEST(Handle, MaxForceIsNeverExceeded) {
  for (const double limit : {1.0, 200.0, 5000.0}) {
    TestWorld world;
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, 1e5), Vec3(0, 0.4, 0));
    system.add(body);
    const HandleId handle = system.grab(body, 40, Vec3(0, 3, 0), limit);
    double strongest = 0;
    for (int i = 0; i < 180; ++i) {
      system.move(handle, Vec3(2 * std::sin(0.1 * i), 1.5, 2 * std::cos(0.23 * i)));
      world.step(1, i % 3 == 0 ? 1.0 / 60 : 1.0 / 240);
      strongest = std::max(strongest, system.handle_force(handle).norm());
    }
    EXPECT_LE(strongest, limit * (1 + 1e-9));
    EXPECT_GT(strongest, 0.9 * limit);
  }
}

TEST(Handle, WeakHandleCannotLift) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  system.grab(body, 0, Vec3(0, 5, 0), 0.3 * 9.81 * body.total_mass());
  world.step(120);
  EXPECT_LT(body.center_of_mass().y(), 0.3);
}

TEST(Handle, ReleaseLetsGo) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  const HandleId handle = system.grab(body, 0, body.points()[0]);
  world.step(120);
  EXPECT_GT(body.center_of_mass().y(), 1.0);
  system.release(handle);
  const double v = body.momentum().y() / body.total_mass();
  world.step(60);
  EXPECT_NEAR(body.momentum().y() / body.total_mass() - v, -9.81, by_precision(1e-9, 1e-4));
  const HandleId again = system.grab(body, 0, body.points()[0]);
  EXPECT_NE(again, handle);
}

// An impossible hold (a point pinned below the floor) must not store up a kick for the release.
TEST(Handle, PinThroughTheFloorStoresNoKick) {
  for (const double depth : {0.3, 0.05}) {
    if (depth < 0.3 && !full_tier()) continue;
    TestWorld world;
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::ball, 1e5), Vec3(0, 0.302, 0));
    system.add(body);
    world.step(60);
    int low = 0;
    for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
      if (body.points()[static_cast<std::size_t>(v)].y() < body.points()[static_cast<std::size_t>(low)].y())
        low = v;
    }
    const HandleId handle = system.grab(body, low, Vec3(0, -depth, 0));
    const int early = by_tier(300, 120, 60), late = by_tier(600, 240, 60);
    world.step(early);
    const double pull_early = system.handle_force(handle).norm();
    world.step(late);
    const double pull_late = system.handle_force(handle).norm();
    std::printf("    pinned %.2f m under the floor: pull %.2e N after %d steps, %.2e N after %d\n", depth,
                pull_early, early, pull_late, early + late);
    EXPECT_LT(pull_late, 2.0 * pull_early + 1.0);
    system.release(handle);
    double fastest = 0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      for (const Vec3& v : body.velocities()) fastest = std::max(fastest, v.norm());
    }
    std::printf("      fastest point after release %.2f m/s\n", fastest);
    EXPECT_LT(fastest, 25.0);  // what the strained skin itself gives back
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
}

TEST(Handle, PullOfTwoOnOnePointAdds) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
  system.add(body);
  system.grab(body, 0, Vec3(10, 0, 0), 6.0);
  system.grab(body, 0, Vec3(10, 0, 0), 6.0);
  world.step(1);
  EXPECT_NEAR(body.momentum().norm(), 12.0 / 60.0, by_precision(1e-9, 1e-6));
}

// Two pins on one point ask for different places: the later one has its way, and neither pulls in vain.
TEST(Handle, LaterOfTwoPinsOnAPointHolds) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  const Vec3 first = body.points()[0], second = first + Vec3(0.05, 0, 0);
  const HandleId older = system.grab(body, 0, first);
  world.step(10);
  const HandleId newer = system.grab(body, 0, second);
  for (int i = 0; i < 60; ++i) {
    world.step();
    ASSERT_LE((body.points()[0] - second).norm(), 1e-6);
    ASSERT_EQ(system.handle_force(older).norm(), 0.0);
  }
  EXPECT_LT(system.profile().counts.iterations, 20);
  system.release(newer);
  world.step(1);
  EXPECT_LE((body.points()[0] - first).norm(), 1e-6);
}

// All points held at a squashed shape: nothing moves, and let go it rings down without gaining energy.
TEST(Handle, HoldsAStrainedShapeStill) {
  for (const auto& [young, squash] :
       {std::pair(1e4, 0.3), {1e5, 0.7}, {1e6, 0.95}, {1e6, 0.8}, {1e8, 0.95}}) {
    TestWorld world;
    world->setGravity(btVector3(0, 0, 0));
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, young), Vec3::Zero());
    system.add(body);
    std::vector<HandleId> handles;
    for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
      Vec3 target = body.points()[static_cast<std::size_t>(v)];
      target.y() *= squash;
      handles.push_back(system.grab(body, v, target));
    }
    world.step(60);
    double fastest = 0;
    for (const Vec3& v : body.velocities()) fastest = std::max(fastest, v.norm());
    EXPECT_LT(fastest, 1e-2) << "E " << young << ", squash " << squash;
    for (const HandleId h : handles) system.release(h);
    const double held = energy_of(body);
    double last = held;
    double gain = 0;
    for (int i = 0; i < 120; ++i) {
      world.step();
      gain = std::max(gain, (energy_of(body) - last) / held);
      last = energy_of(body);
    }
    EXPECT_LE(gain, 1e-12) << "E " << young << ", squash " << squash;
    EXPECT_LT(body.elastic_energy(), 0.5 * held) << "E " << young << ", squash " << squash;
  }
}

// Handles are as good as contacts: what one pulls, the other feels.
TEST(Handle, ImpulseEqualsChangeOfMomentum) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::part, 1e5), Vec3::Zero());
  system.add(body);
  const HandleId handle = system.grab(body, 33, Vec3(1, 1, 0), 400.0);
  for (int i = 0; i < 60; ++i) {
    const Vec3 before = body.momentum();
    world.step();
    const Vec3 change = body.momentum() - before, given = system.handle_force(handle) / 60.0;
    ASSERT_LT((change - given).norm(), by_precision(1e-9, 1e-6) * (1.0 + given.norm())) << "step " << i;
  }
}

}  // namespace
}  // namespace softpoint
