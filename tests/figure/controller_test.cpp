#include <gtest/gtest.h>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include "link_chain.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/articulated_controller.h"

namespace softpoint::figure {
namespace {

// An arm on a base that stands still, swinging about z.
FigureModel swinging_arm() {
  Link base, arm;
  base.name = "base";
  base.joint = JointKind::kFree;
  base.mass = 10;
  base.inertia = Mat3::Identity();
  arm.name = "arm";
  arm.parent = 0;
  arm.mass = 1;
  arm.inertia = 0.1 * Mat3::Identity();
  return FigureModel({base, arm});
}

FigureClip swing() {
  FigureClip clip;
  clip.end = 1;
  clip.tracks = {{1, Interpolation::kSmooth, {{0, {0}, {}}, {0.5, {0.4}, {}}, {1, {1}, {}}}}};
  clip.capsules = {{1, {0.2, 0, 0}, {1, 0, 0}, 0.05}};
  return clip;
}

struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

TEST(ArticulatedController, GoesWhereTheAnimationGoesWithItsVelocityAndPushes) {
  const FigureModel model = swinging_arm();
  FigureAnimation animation(model, swing());
  EXPECT_THROW(
      {
        World empty;
        ArticulatedController early(empty.world, animation);
      },
      Error);
  animation.evaluate();
  World w;
  w.world.setGravity(btVector3(0, 0, 0));
  btBoxShape shape(btVector3(0.1F, 0.1F, 0.1F));
  btRigidBody::btRigidBodyConstructionInfo info(0.5F, nullptr, &shape, btVector3(0.003F, 0.003F, 0.003F));
  info.m_startWorldTransform.setIdentity();
  info.m_startWorldTransform.setOrigin(btVector3(0.8F, 0.5F, 0));
  btRigidBody box(info);
  w.world.addRigidBody(&box);
  {
    ArticulatedController controller(w.world, animation);
    ASSERT_EQ(controller.body_count(), 1);
    EXPECT_EQ(w.world.getNumCollisionObjects(), 2);
    const LinkChain chain(model, 1);
    FigureState state;
    for (int k = 1; k <= 60; ++k) {
      w.world.stepSimulation(btScalar(1) / 60, 0);
      animation.sample(controller.time(), state);
      const PointMotion middle = chain.evaluate({0.6, 0, 0}, state.q.data(), state.qd.data(), nullptr);
      const btRigidBody& body = controller.body(0);
      const btVector3& at = body.getWorldTransform().getOrigin();
      EXPECT_LT((middle.position - Vec3(at.x(), at.y(), at.z())).norm(), 1e-6);
      const btVector3& v = body.getLinearVelocity();
      EXPECT_LT((middle.velocity - Vec3(v.x(), v.y(), v.z())).norm(), 1e-6);
    }
    EXPECT_NEAR(controller.time(), 1, 1e-6);
    EXPECT_GT(box.getLinearVelocity().y(), 0.2);  // at 0.8 m the arm does 0.8 m/s
    EXPECT_GT(box.getWorldTransform().getOrigin().y(), 0.55);
    controller.set_time(0);
    EXPECT_LT(controller.body(0).getWorldTransform().getOrigin().y(), 1e-6);
  }
  EXPECT_EQ(w.world.getNumCollisionObjects(), 1);
  w.world.stepSimulation(btScalar(1) / 60, 0);  // its action has gone too
  w.world.removeRigidBody(&box);
}

// The base is keyed, the limb bends so that its foot stays; then keys take it on from there.
TEST(Feet, StayWhileTheBaseMoves) {
  Link base, thigh, shin;
  base.name = "base";
  base.joint = JointKind::kFree;
  base.mass = 10;
  base.inertia = Mat3::Identity();
  thigh.name = "thigh";
  thigh.parent = 0;
  thigh.axis = Vec3::UnitX();
  thigh.mass = 1;
  thigh.inertia = 0.1 * Mat3::Identity();
  shin = thigh;
  shin.name = "shin";
  shin.parent = 1;
  shin.origin = {0, 0, -0.4};
  shin.lower = 0;
  shin.upper = 2.5;
  const FigureModel model({base, thigh, shin});
  FigureClip clip;
  clip.end = 1;
  clip.tracks = {
      {0, Interpolation::kCubic, {{0, {0, 0, 1, 1, 0, 0, 0}, {}}, {0.5, {0, 0.15, 0.95, 1, 0, 0, 0}, {}}}},
      {1, Interpolation::kCubic, {{0, {-0.4}, {}}, {1, {-0.2}, {}}}},
      {2, Interpolation::kCubic, {{0, {0.8}, {}}, {1, {0.5}, {}}}}};
  clip.places = {{0, 0.5, PlaceRule::kFeet, 2, {0, 0, -0.4}}};
  FigureAnimation animation(model, clip);
  animation.evaluate();
  const LinkChain chain(model, 2);
  const Vec3 foot = chain.evaluate({0, 0, -0.4}, animation.frame(0).q.data(), nullptr, nullptr).position;
  for (int k = 0; k <= 15; ++k) {
    const FigureState& s = animation.frame(k);
    const PointMotion now = chain.evaluate({0, 0, -0.4}, s.q.data(), s.qd.data(), nullptr);
    EXPECT_LT((now.position - foot).norm(), 1e-11) << k;
    if (k > 0) {
      EXPECT_LT(now.velocity.norm(), 1e-6) << k;
    }
  }
  EXPECT_LT(animation.counts().feet_missed, 1e-11);
  EXPECT_GT(std::abs(animation.frame(15).q[7] - animation.frame(0).q[7]), 0.05);
  EXPECT_LT(std::abs(animation.frame(16).q[7] - animation.frame(15).q[7]), 0.05);  // no jump
  EXPECT_NEAR(animation.frame(30).q[7], -0.2, 1e-12);
}

}  // namespace
}  // namespace softpoint::figure
