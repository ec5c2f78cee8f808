// Links of multibodies as colliders, in all worlds that step multibodies.
#include <BulletDynamics/Featherstone/btMultiBodyJointMotor.h>
#include <gtest/gtest.h>

#include <cmath>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/multibodies.h"
#include "support/penetration.h"
#include "support/precision.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;
using Joint = ChainSettings::Joint;

class Multibody : public ::testing::TestWithParam<WorldKind> {};

std::string multibody_world(const ::testing::TestParamInfo<WorldKind>& kind) {
  const char* names[] = {"Discrete", "MultiBody", "SoftRigid", "SoftMultiBody", "Deformable"};
  return names[static_cast<int>(kind.param)];
}

INSTANTIATE_TEST_SUITE_P(Worlds, Multibody,
                         ::testing::Values(WorldKind::multibody, WorldKind::soft_multibody,
                                           WorldKind::deformable),
                         multibody_world);

// A step of the chain is measured against a twin without the body, in the pose the step began with: the
// difference is what the body gave. Bullet's own Euler step keeps the momentum of a moving chain only to
// first order, so the twin takes that out; what a warm start changes of it is not taken out, so several
// joints are measured at the first touch.
TEST_P(Multibody, FreeChainGetsTheMomentumTheBodyLoses) {
  for (const auto& [links, joint] : {std::pair(0, Joint::hinge),
                                     {1, Joint::hinge},
                                     {3, Joint::ball},
                                     {2, Joint::slider},
                                     {2, Joint::planar},
                                     {2, Joint::fixed}}) {
    TestWorld world(GetParam()), twin_world(GetParam());
    Multibodies multibodies(world), twins(twin_world);
    ChainSettings settings{.links = links, .fixed_base = false, .joint = joint};
    settings.axis = joint == Joint::planar ? Vec3::UnitZ() : Vec3(0.3, 0.2, 1).normalized();
    btMultiBody& chain = multibodies.add_chain(settings);
    btMultiBody& twin = twins.add_chain(settings);
    for (TestWorld* w : {&world, &twin_world}) (*w)->setGravity(btVector3(0, 0, 0));
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::ball), Vec3(0.05 + 0.21 * links, 0.37, 0.02));
    body.set_velocity(Vec3(0, -2, 0), Vec3(0, 1, 2));
    system.add(body);
    double worst_linear = 0, worst_angular = 0;
    int touched = 0;
    for (int i = 0; i < 40; ++i) {
      const MultibodyState before = MultibodyState::of(chain);
      before.put_positions(twin);
      before.put_velocities(twin);
      const Vec3 p_before = body.momentum(), l_before = body.angular_momentum();
      twin_world.step();
      world.step();
      if (system.contacts().empty()) continue;
      ++touched;
      MultibodyState alone = MultibodyState::of(twin);
      before.put_positions(twin);
      alone.put_velocities(twin);
      const MultibodyMomentum without = MultibodyMomentum::of(twin);
      MultibodyState::of(chain).put_velocities(twin);
      const MultibodyMomentum with = MultibodyMomentum::of(twin);
      const Vec3 p = body.momentum() - p_before, l = body.angular_momentum() - l_before;
      const double scale = body.total_mass() * 2.0;
      worst_linear = std::max(worst_linear, (p + with.linear - without.linear).norm() / scale);
      worst_angular = std::max(worst_angular, (l + with.angular - without.angular).norm() / scale);
    }
    std::printf("    %d links, joint %d: linear %.1e, angular %.1e, %d steps in contact\n", links,
                static_cast<int>(joint), worst_linear, worst_angular, touched);
    EXPECT_GT(touched, 0);
    EXPECT_LE(worst_linear, by_precision(1e-12, 1e-5));
    EXPECT_LE(worst_angular, by_precision(1e-12, 1e-5));
  }
}

// How a body rests on something: largest depths and the speed of the link over the last seconds.
struct Rest {
  double skin = -1, corner = -1, speed = 0, weight = 0;
};

Rest rest_on(TestWorld& world, DeformableSystem& system, const ElasticBody& body, const btMultiBody& chain,
             int settle, int watched) {
  Rest rest;
  world.step(settle);
  for (int i = 0; i < watched; ++i) {
    world.step();
    for (int link = -1; link < chain.getNumLinks(); ++link) {
      const btCollisionObject& object = link < 0 ? *chain.getBaseCollider() : *chain.getLinkCollider(link);
      rest.skin = std::max(rest.skin, skin_depth(body, object));
      rest.corner = std::max(rest.corner, corner_depth(body, object));
    }
    for (int k = 0; k < 6 + chain.getNumDofs(); ++k) {
      rest.speed = std::max(rest.speed, std::abs(double(chain.getVelocityVector()[k])));
    }
    for (const ContactPoint& c : system.contacts()) {
      rest.weight += c.force.y() / watched;
    }
  }
  rest.weight /= 9.81 * body.total_mass();
  return rest;
}

TEST_P(Multibody, BodyRestsOnAnArmHeldByItsMotor) {
  TestWorld world(GetParam());
  Multibodies multibodies(world);
  btMultiBody& arm = multibodies.add_chain({.links = 1, .half = Vec3(0.3, 0.05, 0.3), .mass = 50});
  btMultiBodyJointMotor motor(&arm, 0, 0, btScalar(1000.0));
  motor.setPositionTarget(0, btScalar(0.5));
  multibodies.world().addMultiBodyConstraint(&motor);
  {
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0.62, 0.26, 0));
    system.add(body);
    const Rest rest = rest_on(world, system, body, arm, 300, 120);
    std::printf(
        "    skin %.2e m, corner %.2e m, joint speed %.1e rad/s, load %.6f of the weight, angle %.2e\n",
        rest.skin, rest.corner, rest.speed, rest.weight, double(arm.getJointPos(0)));
    EXPECT_LE(rest.skin, 1e-3);
    EXPECT_LE(rest.corner, 2e-3);
    EXPECT_LE(rest.speed, 1e-3);
    EXPECT_NEAR(rest.weight, 1.0, 1e-3);
  }
  multibodies.world().removeMultiBodyConstraint(&motor);
}

TEST_P(Multibody, BodyRestsOnAChainThatLiesOnTheFloor) {
  for (const Joint joint : {Joint::hinge, Joint::fixed}) {
    TestWorld world(GetParam());
    world.add_box(Vec3(3, 0.5, 3), 0, Vec3(0, -0.5, 0));
    Multibodies multibodies(world);
    btMultiBody& chain =
        multibodies.add_chain({.links = 2, .fixed_base = false, .base = Vec3(0, 0.05, 0), .joint = joint});
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0.42, 0.31, 0));
    system.add(body);
    const Rest rest = rest_on(world, system, body, chain, 300, 120);
    double sunk = 0;
    for (int link = -1; link < 2; ++link) {
      sunk = std::max(sunk, 0.05 - to_vec(chain.localPosToWorld(link, btVector3(0, 0, 0))).y());
    }
    std::printf("    skin %.2e m, corner %.2e m, speed %.1e, load %.6f of the weight, sunk %.1e m\n",
                rest.skin, rest.corner, rest.speed, rest.weight, sunk);
    EXPECT_LE(rest.skin, 1e-3);
    EXPECT_LE(rest.corner, 2e-3);
    EXPECT_LE(rest.speed, 1e-3);
    EXPECT_NEAR(rest.weight, 1.0, 1e-3);
    EXPECT_LE(sunk, 1e-3);
  }
}

// A door: about its hinge, what the body loses of angular momentum is what the door gains.
TEST_P(Multibody, PendulumTakesTheAngularMomentumAboutItsHinge) {
  TestWorld world(GetParam());
  world->setGravity(btVector3(0, 0, 0));
  Multibodies multibodies(world);
  btMultiBody& door = multibodies.add_chain({.links = 1, .half = Vec3(0.3, 0.05, 0.3), .mass = 10});
  const Vec3 hinge(0.31, 0, 0);
  const double inertia = 1.0 / 3.0 * 10 * (0.3 * 0.3 + 0.05 * 0.05) + 10 * 0.31 * 0.31;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball), Vec3(0.75, 0.4, 0.03));
  body.set_velocity(Vec3(0, -3, 0), Vec3::Zero());
  system.add(body);
  const double before = body.angular_momentum(hinge).z();
  double worst = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    const double total = body.angular_momentum(hinge).z() + inertia * double(door.getJointVel(0));
    worst = std::max(worst, std::abs(total - before) / std::abs(before));
  }
  std::printf("    angular momentum about the hinge: worst change %.1e, joint speed %.2f rad/s\n", worst,
              double(door.getJointVel(0)));
  EXPECT_LT(door.getJointVel(0), -0.5);
  EXPECT_LE(worst, by_precision(1e-12, 1e-5));
}

}  // namespace
}  // namespace softpoint
