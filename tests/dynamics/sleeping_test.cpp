// Bodies at rest stop costing; what disturbs them wakes them, and they go on where they were.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/pile.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

constexpr WorldKind kWorlds[] = {WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                                 WorldKind::soft_multibody, WorldKind::deformable};

// A cube on the floor with a box on it, asleep.
struct Rest {
  explicit Rest(WorldKind kind = WorldKind::discrete, int settle = 600)
      : world(kind),
        floor(world.add_floor()),
        system(*world),
        cube(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0)),
        box(world.add_box(Vec3(0.1, 0.1, 0.1), 5, Vec3(0, 0.51, 0))) {
    box.forceActivationState(ACTIVE_TAG);
    system.add(cube);
    world.step(settle);
  }
  bool all_asleep() const { return cube.asleep() && !box.isActive(); }
  double fastest() const { return std::max(cube.max_speed(), double(box.getLinearVelocity().length())); }

  TestWorld world;
  btRigidBody& floor;
  DeformableSystem system;
  ElasticBody cube;
  btRigidBody& box;
};

TEST(Sleeping, ABodyAtRestFallsAsleepAndStaysAsItIs) {
  for (const WorldKind kind : kWorlds) {
    TestWorld world(kind);
    btRigidBody& floor = world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 0.25, 0));
    system.add(body);
    world.step(60);
    EXPECT_FALSE(body.asleep());
    world.step(360);
    ASSERT_TRUE(body.asleep());
    EXPECT_EQ(body.getActivationState(), ISLAND_SLEEPING);
    EXPECT_EQ(body.max_speed(), 0.0);
    const std::vector<Vec3> before(body.points().begin(), body.points().end());
    world.step(300);
    EXPECT_TRUE(std::equal(before.begin(), before.end(), body.points().begin()));
    Vec3 force = Vec3::Zero();
    for (const ContactPoint& p : system.contacts()) {
      EXPECT_EQ(p.body, &body);
      EXPECT_EQ(p.other, &floor);
      force += p.force;
    }
    EXPECT_NEAR(force.y() / (9.81 * body.total_mass()), 1.0, 1e-2);
  }
}

TEST(Sleeping, ABodyInMotionStaysAwake) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3::Zero());
  system.add(body);
  body.set_velocity(Vec3(1.01 * body.sleep_settings().speed, 0, 0));
  world.step(600);
  EXPECT_FALSE(body.asleep());
  EXPECT_NEAR(body.center_of_mass().x(), 10.1 * body.sleep_settings().speed, 1e-6);
}

TEST(Sleeping, LetsARigidBoxOnItSleep) {
  for (const WorldKind kind : kWorlds) {
    Rest rest(kind);
    EXPECT_TRUE(rest.all_asleep());
    Vec3 load = Vec3::Zero();
    for (const ContactPoint& p : rest.system.contacts()) {
      if (p.other == &rest.box) load -= p.force;
    }
    EXPECT_NEAR(load.y() / (5 * 9.81), 1.0, 1e-2);
  }
}

TEST(Sleeping, KeepsAwakeWhatARestlessNeighbourTouches) {
  Rest rest(WorldKind::discrete, 0);
  rest.box.forceActivationState(DISABLE_DEACTIVATION);
  rest.world.step(600);
  EXPECT_FALSE(rest.cube.asleep());
}

TEST(Sleeping, APileOfEveryShapeSleepsWithinTenSeconds) {
  for (const WorldKind kind : kWorlds) {
    for (const double young : {1e5, 1e6}) {
      Pile pile(kind, young);
      int steps = 0;
      while (steps < 600 && !pile.all_asleep()) {
        pile.world.step();
        ++steps;
      }
      std::printf("    world %d, E %.0e: all asleep after %.1f s\n", int(kind), young, steps / 60.0);
      EXPECT_TRUE(pile.all_asleep());
      EXPECT_EQ(pile.system.profile().totals.late_substeps, 0);
    }
  }
}

double median_step_seconds(TestWorld& world, int count) {
  std::vector<double> seconds;
  for (int i = 0; i < count; ++i) {
    const auto start = std::chrono::steady_clock::now();
    world.step();
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::nth_element(seconds.begin(), seconds.begin() + count / 2, seconds.end());
  return seconds[static_cast<std::size_t>(count / 2)];
}

TEST(Sleeping, CostsNothing) {
  Pile pile;
  pile.world.step(60);
  const double awake = median_step_seconds(pile.world, 60);
  for (int i = 0; i < 600 && !pile.all_asleep(); ++i) {
    pile.world.step();
  }
  pile.world.step();
  ASSERT_TRUE(pile.all_asleep());
  const double asleep = median_step_seconds(pile.world, 301);
  const Profile& p = pile.system.profile();
  EXPECT_EQ(p.counts.deformables, 2);
  EXPECT_EQ(p.counts.sleeping, 2);
  EXPECT_EQ(p.seconds.total(), 0.0);
  EXPECT_EQ(p.counts.without_pairs + p.counts.without_contacts + p.counts.pairs + p.counts.pairs_skipped +
                p.counts.swept_queries + p.counts.contacts + p.counts.support_points + p.counts.handles +
                p.counts.passes + p.counts.iterations,
            0);
  std::printf("    a step of the sleeping world: %.2f us, %.2f %% of the waking one\n", 1e6 * asleep,
              100 * asleep / awake);
  EXPECT_LT(asleep, 0.01 * awake);
}

// What wakes a sleeping cube with a box on it, and what does not.
struct Disturbance {
  const char* name;
  std::function<void(Rest&)> act;
};

class Waking : public ::testing::TestWithParam<Disturbance> {};

TEST_P(Waking, WakesBodyAndBox) {
  for (const WorldKind kind : kWorlds) {
    Rest rest(kind);
    ASSERT_TRUE(rest.all_asleep());
    GetParam().act(rest);
    int steps = 0;
    while (steps < 60 && rest.cube.asleep()) {
      rest.world.step();
      ++steps;
    }
    EXPECT_LT(steps, 60) << "world " << int(kind);
    rest.world.step();
    EXPECT_TRUE(rest.box.isActive());
  }
}

INSTANTIATE_TEST_SUITE_P(
    By, Waking,
    ::testing::Values(
        Disturbance{
            "Touch",
            [](Rest& r) {
              r.world.add_box(Vec3(0.05, 0.05, 0.05), 1, Vec3(0, 0.7, 0)).forceActivationState(ACTIVE_TAG);
            }},
        Disturbance{"Drag",
                    [](Rest& r) { r.system.grab(r.cube, 0, r.cube.points()[0] + Vec3(0, 0.05, 0), 100); }},
        Disturbance{"Impulse", [](Rest& r) { r.cube.apply_impulse(0, Vec3(1, 0, 0), Vec3(1, 0, 0)); }},
        Disturbance{"Velocity", [](Rest& r) { r.cube.set_velocity(Vec3(0.1, 0, 0)); }},
        Disturbance{"Acceleration", [](Rest& r) { r.cube.set_acceleration(Vec3(0, 1, 0)); }},
        Disturbance{"Gravity", [](Rest& r) { r.world->setGravity(btVector3(0, -5, 0)); }},
        Disturbance{"Activate", [](Rest& r) { r.cube.activate(); }},
        Disturbance{"Wake", [](Rest& r) { r.cube.wake(); }},
        Disturbance{"Settings", [](Rest& r) { r.system.set_settings({}); }},
        Disturbance{"SleepSettings", [](Rest& r) { r.cube.set_sleep_settings({}); }},
        Disturbance{"ItsLoad",
                    [](Rest& r) {
                      r.box.activate();
                      r.box.applyCentralImpulse(btVector3(1, 0, 0));
                    }},
        Disturbance{"FloorThatMoves",
                    [](Rest& r) {
                      btTransform pose = r.floor.getWorldTransform();
                      pose.setOrigin(btVector3(0, btScalar(-0.01), 0));
                      r.floor.setWorldTransform(pose);
                    }},
        Disturbance{"KinematicThatComes",
                    [](Rest& r) {
                      btRigidBody& plate = r.world.add_box(Vec3(0.1, 0.1, 0.1), 0, Vec3(0.31, 0.2, 0));
                      plate.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
                      plate.setLinearVelocity(btVector3(-1, 0, 0));
                    }}),
    [](const auto& test) { return test.param.name; });

TEST(Waking, ByAKinematicNeighbourThatMoves) {
  for (const bool turning : {false, true}) {
    TestWorld world;
    btRigidBody& table = world.add_box(Vec3(1, 0.1, 1), 0, Vec3(0, -0.1, 0));
    table.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
    system.add(body);
    world.step(600);
    ASSERT_TRUE(body.asleep());
    btTransform pose = table.getWorldTransform();
    if (turning) {
      pose.setRotation(btQuaternion(btVector3(0, 1, 0), btScalar(1e-3)));
    } else {
      pose.getOrigin() += btVector3(0, btScalar(1e-3), 0);
    }
    table.setWorldTransform(pose);
    world.step();
    EXPECT_FALSE(body.asleep());
  }
}

TEST(Waking, ByLosingWhatItRestsOn) {
  TestWorld world;
  btRigidBody& table = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  world.step(600);
  ASSERT_TRUE(body.asleep());
  world.erase(table);
  world.step(30);
  EXPECT_FALSE(body.asleep());
  EXPECT_LT(body.center_of_mass().y(), -0.5);
}

TEST(Waking, AHandleThatStandsStillLetsItSleep) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
  system.add(body);
  int top = 0;
  for (int v = 0; v < int(body.points().size()); ++v) {
    const auto distance = [&](int i) { return (body.points()[std::size_t(i)] - Vec3(0, 0.2, 0)).norm(); };
    top = distance(v) < distance(top) ? v : top;
  }
  const Vec3 target = body.points()[std::size_t(top)];
  const HandleId handle = system.grab(body, top, target);
  world.step(1200);
  EXPECT_TRUE(body.asleep());
  EXPECT_NEAR(system.handle_force(handle).y() / (9.81 * body.total_mass()), 1.0, 1e-2);
  system.move(handle, target);
  world.step();
  EXPECT_TRUE(body.asleep());
  system.move(handle, target + Vec3(0.01, 0, 0));
  world.step();
  EXPECT_FALSE(body.asleep());
  EXPECT_LT((body.points()[std::size_t(top)] - target - Vec3(0.01, 0, 0)).norm(), 1e-5);
  world.step(1200);
  EXPECT_TRUE(body.asleep());
  system.release(handle);
  world.step(20);
  EXPECT_FALSE(body.asleep());
  EXPECT_LT(body.center_of_mass().y(), target.y() - 0.3);
}

// Load, strain and Bullet's impulses continue: nothing hops, whichever way the pile is woken.
TEST(Waking, KeepsItsLoad) {
  const auto tiny = [](Rest& r) { r.cube.apply_impulse(0, Vec3(1, 0, 0), Vec3(1e-6, 0, 0)); };
  const auto bullets = [](Rest& r) { r.cube.activate(); };
  const auto load = [](Rest& r) {
    r.box.activate();
    r.box.applyCentralImpulse(btVector3(btScalar(1e-6), 0, 0));
  };
  const auto gravity = [](Rest& r) { r.world->setGravity(btVector3(btScalar(1e-6), btScalar(-9.81), 0)); };
  for (const WorldKind kind : kWorlds) {
    for (const auto& wake : {std::function<void(Rest&)>(tiny), std::function<void(Rest&)>(bullets),
                             std::function<void(Rest&)>(load), std::function<void(Rest&)>(gravity)}) {
      for (const int substeps : {1, 4}) {
        Rest rest(kind);
        ASSERT_TRUE(rest.all_asleep());
        wake(rest);
        double fastest = 0;
        for (int i = 0; i < 60 / substeps; ++i) {
          rest.world->stepSimulation(btScalar(substeps / 60.0), substeps, btScalar(1 / 60.0));
          fastest = std::max(fastest, rest.fastest());
          ASSERT_FALSE(rest.cube.asleep());
        }
        std::printf("    world %d, %d substeps: fastest %.1e m/s\n", int(kind), substeps, fastest);
        EXPECT_LT(fastest, 1e-4);
      }
    }
  }
}

// Bullet wakes a chain from its far end, in the middle of a step.
TEST(Waking, ThroughAChainOfRigidBodiesDoesNotHop) {
  for (const WorldKind kind : kWorlds) {
    Rest rest(kind, 60);
    btRigidBody& upper = rest.world.add_box(Vec3(0.05, 0.05, 0.05), 1, Vec3(0, 0.657, 0));
    upper.forceActivationState(ACTIVE_TAG);
    rest.world.step(600);
    ASSERT_TRUE(rest.all_asleep());
    ASSERT_FALSE(upper.isActive());
    upper.activate();
    double fastest = 0;
    for (int i = 0; i < 60; ++i) {
      rest.world.step();
      fastest = std::max({fastest, rest.fastest(), double(upper.getLinearVelocity().length())});
    }
    EXPECT_FALSE(rest.cube.asleep());
    std::printf("    world %d: fastest %.1e m/s\n", int(kind), fastest);
    EXPECT_LT(fastest, 5e-3);
  }
}

// A cube and a box that stand apart, tied by an anchor: Bullet's islands do not know that they belong
// together.
struct Tied {
  explicit Tied(WorldKind kind)
      : world(kind),
        floor(world.add_box(Vec3(3, 0.5, 3), 0, Vec3(0, -0.5, 0))),
        system(*world),
        cube(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0)),
        box(world.add_box(Vec3(0.1, 0.1, 0.1), 5, Vec3(0.6, 0.1, 0))) {
    box.forceActivationState(ACTIVE_TAG);
    system.add(cube);
    world.step(60);
    system.attach(cube, 0, box);
    cube.set_sleep_settings({.speed = 0.1, .time = 3.0});  // later than the box
    for (int i = 0; i < 600; ++i) {
      world.step();
      apart += cube.asleep() == box.isActive();
    }
  }
  bool all_asleep() const { return cube.asleep() && !box.isActive(); }
  double fastest() const { return std::max(cube.max_speed(), double(box.getLinearVelocity().length())); }

  TestWorld world;
  btRigidBody& floor;
  DeformableSystem system;
  ElasticBody cube;
  btRigidBody& box;
  int apart = 0;  // steps in which one slept and the other did not
};

TEST(Sleeping, WhatIsTiedTogetherSleepsAndWakesTogether) {
  for (const WorldKind kind : kWorlds) {
    for (const bool by_the_box : {false, true}) {
      Tied tied(kind);
      ASSERT_TRUE(tied.all_asleep());
      EXPECT_EQ(tied.apart, 0);
      tied.world.step(60);
      ASSERT_TRUE(tied.all_asleep());
      if (by_the_box) {
        tied.box.activate();
        tied.box.applyCentralImpulse(btVector3(0, 0, btScalar(1e-6)));
      } else {
        tied.cube.apply_impulse(0, Vec3(1, 0, 0), Vec3(1e-6, 0, 0));
      }
      double fastest = 0;
      for (int i = 0; i < 60; ++i) {
        tied.world.step();
        EXPECT_FALSE(tied.cube.asleep());
        EXPECT_TRUE(tied.box.isActive());
        fastest = std::max(fastest, tied.fastest());
      }
      std::printf("    world %d: fastest %.1e m/s\n", int(kind), fastest);
      EXPECT_LT(fastest, 1e-3);
      tied.world.step(400);
      EXPECT_TRUE(tied.all_asleep());
    }
  }
}

TEST(Sleeping, NoOneSleepsWhoIsTiedToTheRestless) {
  Tied tied(WorldKind::discrete);
  tied.box.forceActivationState(DISABLE_DEACTIVATION);
  tied.world.step(600);
  EXPECT_FALSE(tied.cube.asleep());
}

TEST(Waking, ByLosingWhatItHangsOn) {
  TestWorld world;
  btRigidBody& hook = world.add_box(Vec3(0.1, 0.1, 0.1), 0, Vec3(0, 0.9, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
  system.add(body);
  for (int v = 0; v < int(body.points().size()); ++v) {
    if (body.points()[std::size_t(v)].y() > 0.19) system.attach(body, v, hook);
  }
  world.step(900);
  ASSERT_TRUE(body.asleep());
  const double height = body.center_of_mass().y();
  btTransform pose = hook.getWorldTransform();
  pose.getOrigin() += btVector3(0, btScalar(0.01), 0);
  hook.setWorldTransform(pose);
  world.step();
  EXPECT_FALSE(body.asleep());
  world.step(900);
  ASSERT_TRUE(body.asleep());
  EXPECT_NEAR(body.center_of_mass().y(), height + 0.01, 1e-4);
  world.erase(hook);
  world.step(30);
  EXPECT_FALSE(body.asleep());
  EXPECT_LT(body.center_of_mass().y(), height - 0.5);
}

TEST(Sleeping, IsForbiddenByBulletsSwitches) {
  for (const int way : {0, 1, 2}) {
    TestWorld world;
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
    if (way == 0) body.setActivationState(DISABLE_DEACTIVATION);
    if (way == 1) body.set_sleep_settings({.speed = 0, .time = {}});
    gDisableDeactivation = way == 2;
    system.add(body);
    world.step(600);
    gDisableDeactivation = false;
    EXPECT_FALSE(body.asleep()) << way;
  }
}

TEST(Sleeping, ItsTimeIsTheOneThatIsSet) {
  for (const double time : {0.25, 5.0}) {
    TestWorld world;
    DeformableSystem system(*world);
    world->setGravity(btVector3(0, 0, 0));
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
    body.set_sleep_settings({.speed = 0.1, .time = time});
    system.add(body);
    int steps = 0;
    while (!body.asleep() && steps < 1000) {
      world.step();
      ++steps;
    }
    EXPECT_NEAR(steps / 60.0, time, 3 / 60.0);
  }
}

TEST(Sleeping, ADisabledBodyIsFrozenAndGoesOn) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3(0, 2, 0));
  system.add(body);
  world.step(10);
  const Vec3 place = body.center_of_mass(), momentum = body.momentum();
  body.forceActivationState(DISABLE_SIMULATION);
  body.apply_impulse(0, Vec3(1, 0, 0), Vec3(0, 1, 0));
  world.step(100);
  EXPECT_EQ(body.center_of_mass(), place);
  EXPECT_EQ(body.momentum(), momentum);
  body.forceActivationState(ACTIVE_TAG);
  world.step(5);
  EXPECT_NEAR(body.momentum().y(), momentum.y() + 1 - 5 / 60.0 * 9.81 * body.total_mass(), 1e-3);
}

TEST(Sleeping, ABodyTakenOutAndPutBackIsAwake) {
  Rest rest;
  rest.system.remove(rest.cube);
  EXPECT_FALSE(rest.cube.asleep());
  rest.world.step(2);
  EXPECT_TRUE(rest.box.isActive());
  EXPECT_LT(rest.box.getLinearVelocity().y(), 0);
  rest.system.add(rest.cube);
  rest.world.step();
  EXPECT_FALSE(rest.cube.asleep());
}

TEST(SleepSettings, RefusesWhatIsOutOfRange) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3::Zero());
  const auto with = [&](double speed, std::optional<double> time) {
    return [&body, speed, time] { body.set_sleep_settings({.speed = speed, .time = time}); };
  };
  const double nan = std::nan("");
  EXPECT_NE(refusal(with(-1, {})).find("SleepSettings.speed"), std::string::npos);
  EXPECT_NE(refusal(with(nan, {})).find("SleepSettings.speed"), std::string::npos);
  EXPECT_NE(refusal(with(0.1, -1)).find("SleepSettings.time"), std::string::npos);
  EXPECT_NE(refusal(with(0.1, nan)).find("SleepSettings.time"), std::string::npos);
  EXPECT_EQ(body.sleep_settings().speed, SleepSettings().speed);
}

}  // namespace
}  // namespace softpoint
