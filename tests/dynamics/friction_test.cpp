// Coulomb friction and restitution between a body and rigid surfaces.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/penetration.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

// A stiff cube on a slope; gravity is turned instead of the floor, or the box under it is.
struct Slope {
  enum class Ground { plane, turned_plane, turned_box };

  Slope(double angle, double friction, Ground ground)
      : body(model_of(Shape::cube, 1e7), origin(angle, ground), turn(angle, ground)) {
    const btVector3 up = to_bt(turn(angle, ground).col(1));
    btRigidBody* floor = nullptr;
    const btQuaternion turned(btVector3(0, 0, 1), btScalar(-angle));
    switch (ground) {
      case Ground::plane:
        floor = &world.add_floor();
        world->setGravity(btVector3(btScalar(9.81 * std::sin(angle)), btScalar(-9.81 * std::cos(angle)), 0));
        break;
      case Ground::turned_plane:
        floor = &world.add(new btStaticPlaneShape(up, 0), 0, Vec3::Zero());
        break;
      case Ground::turned_box:
        floor = &world.add_box(Vec3(20, 0.5, 2), 0, to_vec(btScalar(-0.5) * up), turned);
        break;
    }
    system = std::make_unique<DeformableSystem>(*world);
    floor->setFriction(1);
    body.setFriction(btScalar(friction));
    body.setActivationState(DISABLE_DEACTIVATION);  // it gathers speed slowly
    system->add(body);
    down = turn(angle, ground).col(0);
  }
  ~Slope() { system.reset(); }

  static Mat3 turn(double angle, Ground ground) {
    return ground == Ground::plane ? Mat3(Mat3::Identity())
                                   : Eigen::AngleAxisd(-angle, Vec3::UnitZ()).toRotationMatrix();
  }
  static Vec3 origin(double angle, Ground ground) { return 0.2011 * turn(angle, ground).col(1); }
  double speed() const { return body.momentum().dot(down) / body.total_mass(); }

  TestWorld world;
  ElasticBody body;
  std::unique_ptr<DeformableSystem> system;
  Vec3 down;
};

using Ground = Slope::Ground;

TEST(Friction, SlidingBeginsAtTheAngleOfFriction) {
  for (const Ground ground : {Ground::plane, Ground::turned_plane, Ground::turned_box}) {
    for (const double mu : {0.2, 0.5, 0.7}) {
      const double angle = std::atan(mu);
      Slope below(0.99 * angle, mu, ground), above(1.01 * angle, mu, ground);
      below.world.step(60);
      above.world.step(60);
      const double start_below = below.body.center_of_mass().dot(below.down);
      const double v_above = above.speed();
      below.world.step(180);
      above.world.step(180);
      EXPECT_LT(std::abs(below.body.center_of_mass().dot(below.down) - start_below), 2e-4)
          << "mu " << mu << ", ground " << static_cast<int>(ground);
      // Above the threshold it gains speed at g (sin a - mu cos a).
      const double expected = 9.81 * (std::sin(1.01 * angle) - mu * std::cos(1.01 * angle)) * 3.0;
      EXPECT_GT(above.speed() - v_above, 0.5 * expected)
          << "mu " << mu << ", ground " << static_cast<int>(ground);
    }
  }
}

TEST(Friction, SlidingAccelerationIsThatOfCoulomb) {
  for (const Ground ground : {Ground::plane, Ground::turned_plane, Ground::turned_box}) {
    for (const double mu : {0.0, 0.2, 0.4}) {
      const double angle = 0.6;
      Slope slope(angle, mu, ground);
      slope.world.step(30);
      const double v = slope.speed();
      slope.world.step(60);
      const double expected = 9.81 * (std::sin(angle) - mu * std::cos(angle));
      EXPECT_NEAR((slope.speed() - v) / expected, 1.0, 0.02)
          << "mu " << mu << ", ground " << static_cast<int>(ground);
    }
  }
}

TEST(Friction, ForcesStayInTheCone) {
  Slope slope(0.3, 0.5, Ground::turned_box);
  for (int i = 0; i < 120; ++i) {
    slope.world.step();
    for (const ContactPoint& p : slope.system->contacts()) {
      const double push = p.force.dot(p.normal);
      const double friction = (p.force - push * p.normal).norm();
      ASSERT_GE(push, 0.0);
      ASSERT_LE(friction, 0.5 * push * (1.0 + 1e-6) + 1e-9);
    }
  }
}

TEST(Friction, NewCoefficientIsHeededInMidContact) {
  Slope slope(0.3, 0.9, Ground::turned_box);
  slope.world.step(60);
  EXPECT_LT(std::abs(slope.speed()), 1e-3);
  slope.body.setFriction(0);
  slope.world.step(60);
  EXPECT_NEAR(slope.speed(), 9.81 * std::sin(0.3), 0.1);
}

// A box slides down a body's flat top: the same law seen from the other side.
TEST(Friction, BoxOnBodySlidesByCoulomb) {
  for (const double mu : {0.1, 0.3}) {
    TestWorld world;
    world.add_floor();
    const double angle = 0.5;
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::bar, 1e8), Vec3(0, 0.101, 0));
    system.add(body);
    for (int i = 0; i < static_cast<int>(body.points().size()); ++i) {
      if (body.points()[static_cast<std::size_t>(i)].y() < 0.01) {
        system.grab(body, i, body.points()[static_cast<std::size_t>(i)]);
      }
    }
    btRigidBody& box = world.add_box(Vec3(0.05, 0.05, 0.05), 0.5, Vec3(-0.35, 0.252, 0));
    box.setFriction(1);
    body.setFriction(btScalar(mu));
    world->setGravity(btVector3(btScalar(9.81 * std::sin(angle)), btScalar(-9.81 * std::cos(angle)), 0));
    for (btRigidBody* b : {&box}) b->setGravity(world->getGravity());
    world.step(10);
    const double v = box.getLinearVelocity().x();
    world.step(12);
    const double expected = 9.81 * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_NEAR((box.getLinearVelocity().x() - v) / 0.2 / expected, 1.0, 0.02) << "mu " << mu;
  }
}

// Speed after the first bounce over the speed of the impact.
double rebound(Shape shape, double young, double dt, double e, bool on_box) {
  TestWorld world;
  btRigidBody& floor = on_box ? world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0)) : world.add_floor();
  floor.setRestitution(1);
  DeformableSystem system(*world);
  ElasticBody body(model_of(shape, young, dt), Vec3(0, 0.8, 0));
  body.setRestitution(btScalar(e));
  system.add(body);
  double down = 0, up = 0;
  for (int i = 0; i < static_cast<int>(0.6 / dt); ++i) {
    world.step(1, dt);
    const double v = body.momentum().y() / body.total_mass();
    down = std::min(down, v);
    up = std::max(up, v);
  }
  return -up / down;
}

TEST(Restitution, ReboundOfAStiffBall) {
  for (const bool on_box : {false, true}) {
    for (const double e : {0.0, 0.3, 0.6, 0.9, 1.0}) {
      const double measured = rebound(Shape::ball, 1e10, 1.0 / 240, e, on_box);
      std::printf("    e = %.1f on %s: rebound %.3f\n", e, on_box ? "box" : "plane", measured);
      EXPECT_NEAR(measured, e, 0.02) << (on_box ? "box" : "plane");
    }
  }
}

// Of bodies whose blow is over within a step or two. Softer ones give back what they give back by their
// elasticity; restitution, which acts point by point at the first touch, then works against it (see the
// README of core).
TEST(Restitution, MoreOfItNeverBouncesLess) {
  for (const double young : {1e9, 1e10}) {
    double last = 0;
    for (const double e : {0.0, 0.3, 0.6, 1.0}) {
      const double measured = rebound(Shape::ball, young, 1.0 / 60, e, false);
      EXPECT_GT(measured, last - 0.02) << "E " << young << ", e " << e;
      last = measured;
    }
  }
}

TEST(Restitution, OfOneIsNoMotor) {
  EXPECT_LT(rebound(Shape::cube, 1e10, 1.0 / 60, 1.0, false), 1.01);
  EXPECT_LT(rebound(Shape::ball, 1e10, 1.0 / 60, 1.0, true), 1.01);
}

TEST(Restitution, NeverGainsEnergy) {
  TestWorld world;
  world.add_floor().setRestitution(1);
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 1.0, 0),
                   Eigen::AngleAxisd(0.5, Vec3(1, 0, 2).normalized()).toRotationMatrix());
  body.setRestitution(1);
  body.setFriction(0);
  system.add(body);
  const double first = energy_of(body) + body.total_mass() * 9.81 * body.center_of_mass().y();
  double highest = 0;
  for (int i = 0; i < 600; ++i) {
    world.step();
    highest = std::max(highest, energy_of(body) + body.total_mass() * 9.81 * body.center_of_mass().y());
  }
  EXPECT_LT(highest, 1.02 * first);
}

}  // namespace
}  // namespace softpoint
