// What limp limbs of a figure in a Bullet world run into: within the step, however fast.
#include <gtest/gtest.h>

#include "capsule_distance.h"
#include "controller_room.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

// The doll flying at a velocity, limp from the first step on.
std::unique_ptr<FigureAnimation> flying_doll(const FigureModel& model, const Vec3& from, const Vec3& velocity,
                                             const AnimationSettings& settings) {
  FigureClip clip = doll_clip();
  const JointKey start{0,
                       {from.x(), from.y(), from.z(), 0.9, 0.3, 0.2, 0.1},
                       {0, 0, 0, velocity.x(), velocity.y(), velocity.z()}};
  JointKey end = start;
  end.time = 10;
  for (int k = 0; k < 3; ++k) end.q[static_cast<std::size_t>(k)] += 10 * velocity[k];
  clip.tracks[0] = {0, Interpolation::kCubic, {start, end}};
  auto animation = std::make_unique<FigureAnimation>(model, clip, settings);
  animation->evaluate();
  return animation;
}

// How deep any capsule is in any box, m.
double deepest(const Room& room, const ArticulatedController& controller) {
  FigureDynamics placer(controller.animation().model());
  placer.place(controller.state().q.data(), controller.state().qd.data());
  double worst = 0;
  for (const LinkCapsule& c : controller.animation().clip().capsules) {
    const LinkMotion m = placer.motion(c.link);
    for (const auto& box : room.boxes) {
      const btTransform back = box->getWorldTransform().inverse();
      const auto local = [&](const Vec3& x) {
        const Vec3 world = m.position + m.orientation * x;
        return vec(back * btVector3(btScalar(world.x()), btScalar(world.y()), btScalar(world.z())));
      };
      const Vec3 half =
          vec(static_cast<const btBoxShape*>(box->getCollisionShape())->getHalfExtentsWithMargin());
      worst = std::max(worst, c.radius - segment_to_box(local(c.from), local(c.to), half).distance);
    }
  }
  return worst;
}

TEST(ControllerContact, NeverTunnelsAPlateOfACentimetre) {
  const FigureModel model = doll();
  for (const bool flies : {true, false}) {
    for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240}) {
      const auto animation =
          flying_doll(model, Vec3(0, 0, 1), flies ? Vec3(50, 0, 0) : Vec3(0, 0, 0), weightless());
      Room room;
      room.world.setGravity(btVector3(0, 0, 0));
      btRigidBody& plate = room.box(btVector3(0.005, 20, 20), flies ? 0 : 1e5, btVector3(3, 0, 1));
      if (!flies) plate.setLinearVelocity(btVector3(-50, 0, 0));
      ArticulatedController controller(room.world, *animation);
      controller.hand_over(0, true);
      double deep = 0, beyond = -1e300;
      for (int k = 0; k * dt < 0.5; ++k) {
        room.world.stepSimulation(static_cast<btScalar>(dt), 0);
        deep = std::max(deep, deepest(room, controller));
        const double front = static_cast<double>(plate.getWorldTransform().getOrigin().x());
        for (int i = 0; i < controller.body_count(); ++i) {
          beyond = std::max(
              beyond, static_cast<double>(controller.body(i).getWorldTransform().getOrigin().x()) - front);
        }
      }
      std::printf("    %s, dt %.4f: deepest %.1e m, middle of a capsule %.3f m before the plate\n",
                  flies ? "figure flies" : "plate flies", dt, deep, -beyond);
      EXPECT_LE(deep, 1e-4);
      EXPECT_LT(beyond, 0);
      EXPECT_GT(controller.counts().impulse.norm(), 100);
      EXPECT_EQ(controller.counts().guard_fired, 0);
    }
  }
}

TEST(ControllerContact, DroppedFromTenMetresNoCapsuleIsDeeperThanATenthOfAMillimetre) {
  const FigureModel model = doll();
  for (const double dt : {1.0 / 30, 1.0 / 120}) {
    const auto animation = flying_doll(model, Vec3(0, 0, 11), Vec3::Zero(), {});
    Room room;
    room.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    room.box(btVector3(10, 10, 0.5), 0, btVector3(0, 0, -0.5));
    room.box(btVector3(0.3, 0.3, 0.3), 0, btVector3(0.3, 0.1, 0.3));
    ArticulatedController controller(room.world, *animation);
    controller.hand_over(0, true);
    double deep = 0;
    for (int k = 0; k * dt < 3; ++k) {
      room.world.stepSimulation(static_cast<btScalar>(dt), 0);
      deep = std::max(deep, deepest(room, controller));
    }
    FigureDynamics placer(model);
    placer.place(controller.state().q.data(), controller.state().qd.data());
    std::printf("    dt %.4f: deepest %.1e m, kinetic energy left %.2f of %.0f J\n", dt, deep,
                placer.mechanics().kinetic_energy, model.total_mass() * 98.1);
    EXPECT_LE(deep, 1e-4);
    EXPECT_LE(placer.mechanics().kinetic_energy, 1);
  }
}

// Keyed, it needs no dynamics and looks for nothing; limp, it looks at what is near alone.
TEST(ControllerContact, WhatIsKeyedDoesNoDynamicsAndWhatIsFarIsNotLookedAt) {
  const FigureModel model = doll();
  const auto animation = flying_doll(model, Vec3(0, 0, 1), Vec3::Zero(), {});
  const auto run = [&](int far, bool limp) {
    Room room;
    room.world.setGravity(btVector3(0, 0, btScalar(-9.81)));
    room.box(btVector3(10, 10, 0.5), 0, btVector3(0, 0, -0.5));
    for (int i = 0; i < far; ++i) room.box(btVector3(0.2, 0.2, 0.2), 0, btVector3(btScalar(5 + i), 3, 5));
    ArticulatedController controller(room.world, *animation);
    if (limp) controller.hand_over(0, true);
    for (int k = 0; k < 60; ++k) room.world.stepSimulation(btScalar(1) / 60, 0);
    return controller.counts();
  };
  const ControllerCounts keyed = run(3, false), alone = run(0, true), crowded = run(30, true);
  EXPECT_EQ(keyed.forward_calls + keyed.narrow_tests + keyed.boxes_overlapping + keyed.contacts, 0);
  EXPECT_GT(alone.narrow_tests, 60);
  EXPECT_EQ(alone.narrow_tests, alone.boxes_overlapping);
  EXPECT_EQ(crowded.narrow_tests, alone.narrow_tests);
  EXPECT_EQ(crowded.forward_calls, alone.forward_calls);
  std::printf("    limp: %lld forward dynamics, %lld narrow tests in 60 steps\n", alone.forward_calls,
              alone.narrow_tests);
}

}  // namespace
}  // namespace softpoint::figure
