// A figure in a Bullet world whose joints are handed to dynamics and back at run time.
#include <gtest/gtest.h>

#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <memory>

#include "controller_room.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/articulated_controller.h"
#include "support.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

struct Momenta {
  Vec3 linear, angular;
  double energy;
};
Momenta momenta(const Room& room, const ArticulatedController& controller) {
  FigureDynamics placer(controller.animation().model());
  placer.place(controller.state().q.data(), controller.state().qd.data());
  const FigureMechanics sums = placer.mechanics();
  Momenta all{sums.momentum, sums.angular_momentum, sums.kinetic_energy};
  for (const auto& body : room.boxes) {
    if (body->isStaticOrKinematicObject()) continue;
    const double mass = 1 / static_cast<double>(body->getInvMass());
    const Vec3 p = mass * vec(body->getLinearVelocity());
    const btMatrix3x3 inertia = body->getInvInertiaTensorWorld().inverse();
    const Vec3 spin = vec(inertia * body->getAngularVelocity());
    all.linear += p;
    all.angular += vec(body->getCenterOfMassPosition()).cross(p) + spin;
    all.energy += 0.5 * p.squaredNorm() / mass + 0.5 * spin.dot(vec(body->getAngularVelocity()));
  }
  return all;
}

TEST(ControllerDynamics, MomentumGoesBothWaysBetweenALimpFigureAndBoxes) {
  const FigureModel model = doll();
  FigureAnimation animation(model, doll_clip(), weightless());
  animation.evaluate();
  Room room;
  room.world.setGravity(btVector3(0, 0, 0));
  room.box(btVector3(0.2, 0.2, 0.2), 3, btVector3(0.25, -1.2, 1.55)).setLinearVelocity(btVector3(0, 3, 0));
  room.box(btVector3(0.25, 0.25, 0.25), 50, btVector3(-0.3, 1.5, 1.1))
      .setLinearVelocity(btVector3(0, -2, 0.1));
  ArticulatedController controller(room.world, animation);
  controller.hand_over(0, true);
  EXPECT_TRUE(controller.dynamic(0) && controller.dynamic(4));
  const Momenta before = momenta(room, controller);
  double energy = before.energy, rise = 0, linear = 0, angular = 0;
  for (int k = 0; k < 180; ++k) {
    room.world.stepSimulation(btScalar(1) / 60, 0);
    const Momenta now = momenta(room, controller);
    rise = std::max(rise, now.energy - energy);
    energy = now.energy;
    linear = std::max(linear, (now.linear - before.linear).norm());
    angular = std::max(angular, (now.angular - before.angular).norm());
  }
  std::printf(
      "    momentum off by %.1e of %.0f, its moment by %.1e of %.0f, energy %.0f to %.0f J, rise %.1e\n",
      linear, before.linear.norm(), angular, before.angular.norm(), before.energy, energy, rise);
  EXPECT_LE(linear, 1e-9 * before.linear.norm());
  EXPECT_LE(angular, 1e-9 * before.angular.norm());  // cubes: Bullet keeps theirs
  EXPECT_GT(controller.counts().impulse.norm(), 3);
  EXPECT_GT((vec(room.boxes[0]->getLinearVelocity()) - Vec3(0, 3, 0)).norm(), 0.3);
  EXPECT_GT(controller.counts().contacts, 0);
  EXPECT_EQ(controller.counts().guard_fired, 0);
  EXPECT_LE(rise, 1e-3 * before.energy);
}

// Both ways positions and rates go on as they are.
TEST(ControllerDynamics, HandingOverAndBackHasNoJump) {
  const FigureModel model = doll();
  FigureAnimation animation(model, doll_clip());
  animation.evaluate();
  Room room;
  ArticulatedController controller(room.world, animation);
  const auto step = [&](int count) {
    for (int k = 0; k < count; ++k) room.world.stepSimulation(btScalar(1) / 240, 0);
  };
  const auto largest = [](const std::vector<double>& a, const std::vector<double>& b) {
    double most = 0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
  };
  FigureState last;
  const auto hand = [&](int link, bool dynamic) {
    const FigureState before = controller.state();
    controller.hand_over(link, dynamic);
    EXPECT_EQ(largest(before.q, controller.state().q), 0);
    EXPECT_EQ(largest(before.qd, controller.state().qd), 0);
    step(1);
    double fastest = 0;
    for (const double v : before.qd) fastest = std::max(fastest, std::abs(v));
    EXPECT_LT(largest(before.q, controller.state().q), (fastest + 1) / 240) << link << dynamic;
    EXPECT_LT(largest(before.qd, controller.state().qd), 1) << link << dynamic;  // 240 rad/s2
  };
  step(60);
  hand(1, true);  // an arm
  step(60);
  hand(0, true);  // everything
  step(40);
  FigureState keyed;
  animation.sample(controller.time(), keyed);
  EXPECT_GT(largest(keyed.q, controller.state().q), 0.1);
  hand(0, false);
  step(80);  // 0.3 s later it is where the animation is
  animation.sample(controller.time(), keyed);
  EXPECT_LT(largest(keyed.q, controller.state().q), 1e-9);
  EXPECT_LT(largest(keyed.qd, controller.state().qd), 1e-9);
  EXPECT_EQ(controller.counts().handovers, 3);
  EXPECT_EQ(controller.counts().guard_fired, 0);
}

// The clip's own dynamic interval, simulated in the world: the same motion where nothing is in the way,
// another where something is, and that is pushed.
TEST(ControllerDynamics, DynamicIntervalsFeelTheWorldWhenLive) {
  const FigureModel model = doll();
  FigureClip clip = doll_clip();
  clip.end = 2;
  clip.dynamics = {{0.5, 1.2, {1, 2}}};
  AnimationSettings settings;
  settings.substeps = 8;
  FigureAnimation animation(model, clip, settings);
  animation.evaluate();
  ControllerSettings live;
  live.live = true;
  const auto difference = [&](bool blocked) {
    Room room;
    if (blocked)
      room.box(btVector3(0.15, 0.1, 0.3), 1, btVector3(0.2, -0.45, 1.3)).setGravity(btVector3(0, 0, 0));
    room.world.setGravity(btVector3(0, 0, 0));
    ArticulatedController controller(room.world, animation, btBroadphaseProxy::KinematicFilter,
                                     btBroadphaseProxy::AllFilter, live);
    double most = 0;
    FigureState keyed;
    for (int k = 0; k < 68; ++k) {
      room.world.stepSimulation(btScalar(1) / 60, 0);
      animation.sample(controller.time(), keyed);
      for (std::size_t i = 7; i < keyed.q.size(); ++i)
        most = std::max(most, std::abs(keyed.q[i] - controller.state().q[i]));
    }
    if (blocked) {
      EXPECT_GT(vec(room.boxes[0]->getLinearVelocity()).norm(), 0.05);
    }
    EXPECT_EQ(controller.counts().handovers, 1);
    return most;
  };
  const double open = difference(false), met = difference(true);
  std::printf("    off the animation by %.1e, with a box in the way by %.2f\n", open, met);
  EXPECT_LT(open, 0.01);
  EXPECT_GT(met, 0.05);
}

std::unique_ptr<FigureAnimation> swaying_humanoid(const FigureModel& model) {
  FigureClip clip;
  clip.end = 3;
  RandomFigures random(5);
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    JointTrack track{i, Interpolation::kSmooth, {}};
    for (const double time : {0.0, 1.0, 2.0, 3.0}) {
      const double u = 0.5 + 0.2 * std::tanh(random.vector().x());
      if (i == 0) {
        track.keys.push_back({time, {0.1 * time, 0, 1.6, 1, 0.1 * u, 0, 0.1}, {}});
      } else {
        track.keys.push_back({time, {link.lower + u * (link.upper - link.lower)}, {}});
      }
    }
    clip.tracks.push_back(track);
    if (link.mass > 0) clip.capsules.push_back({i, {0, 0, 0}, link.center_of_mass, 0.05});
  }
  auto animation = std::make_unique<FigureAnimation>(model, clip);
  animation->evaluate();
  return animation;
}

FigureModel rubbed_humanoid() {
  std::vector<Link> links = read_amdl_file(data_file("mjhum27.amdl")).links();
  for (Link& link : links) {
    link.armature = 0.01;
    link.damping = 0.2;
  }
  return FigureModel(links);
}

TEST(ControllerDynamics, ARagdollComesToRestOnAFloorAndABox) {
  const FigureModel model = rubbed_humanoid();
  const auto animation = swaying_humanoid(model);
  Room room;
  room.world.setGravity(btVector3(0, 0, -9.81));
  room.box(btVector3(10, 10, 0.5), 0, btVector3(0, 0, -0.5));
  room.box(btVector3(0.2, 0.2, 0.2), 20, btVector3(0.3, 0, 0.2));
  ArticulatedController controller(room.world, *animation);
  controller.hand_over(0, true);
  double deepest = 0, last = 0;
  for (int k = 0; k < by_tier(480, 300, 30); ++k) {
    last = 0;
    room.world.stepSimulation(btScalar(1) / 120, 0);
    for (int i = 0; i < controller.body_count(); ++i) {
      const btRigidBody& body = controller.body(i);
      const auto& shape = static_cast<const btCapsuleShape&>(*body.getCollisionShape());
      const double half = static_cast<double>(shape.getHalfHeight()),
                   radius = static_cast<double>(shape.getRadius());
      const Vec3 axis = vec(body.getWorldTransform().getBasis().getColumn(2));
      const double low =
          static_cast<double>(body.getWorldTransform().getOrigin().z()) - std::abs(half * axis.z()) - radius;
      last = std::min(last, low);
    }
    deepest = std::min(deepest, last);
  }
  FigureDynamics placer(model);
  placer.place(controller.state().q.data(), controller.state().qd.data());
  std::printf("    deepest %.3f mm, at the end %.3f mm, kinetic energy left %.2f J, trunk at %.2f m\n",
              -1e3 * deepest, -1e3 * last, placer.mechanics().kinetic_energy, controller.state().q[2]);
  EXPECT_EQ(controller.counts().guard_fired, 0);
  EXPECT_GT(deepest, -1e-4);
  if (kInstrumented) return;
  EXPECT_GT(last, -2e-3);
  EXPECT_LT(controller.state().q[2], 0.8);
  EXPECT_LT(placer.mechanics().kinetic_energy, 5);
}

// Steps of 1/15 to 1/1000 s, handovers of any limb at any time, things in the way.
TEST(ControllerDynamics, RandomHandoversInAWorldStayFinite) {
  const FigureModel model = rubbed_humanoid();
  const auto animation = swaying_humanoid(model);
  Room room;
  room.world.setGravity(btVector3(0, 0, -9.81));
  room.box(btVector3(10, 10, 0.5), 0, btVector3(0, 0, -0.5));
  for (int k = 0; k < 4; ++k)
    room.box(btVector3(0.15, 0.15, 0.15), 1 + 10 * k, btVector3(0.3 * k - 0.4, 0.2, 0.3));
  ArticulatedController controller(room.world, *animation);
  RandomFigures random(17);
  const int steps = by_tier(100000, 1500, 1000);
  for (int k = 0; k < steps; ++k) {
    if (random.below(10) == 0) controller.hand_over(random.below(model.link_count()), random.coin());
    if (random.below(400) == 0) {  // everything back to the beginning
      controller.set_time(0);
      for (std::size_t i = 1; i < room.boxes.size(); ++i) {
        btTransform at(btQuaternion::getIdentity(),
                       btVector3(0.3 * static_cast<btScalar>(i) - 0.7, 0.2, 0.3));
        room.boxes[i]->setWorldTransform(at);
        room.boxes[i]->setLinearVelocity(btVector3(0, 0, 0));
        room.boxes[i]->setAngularVelocity(btVector3(0, 0, 0));
      }
    }
    room.world.stepSimulation(btScalar(1) / static_cast<btScalar>(15 + random.below(986)), 0);
    for (const double x : controller.state().q) ASSERT_TRUE(std::isfinite(x)) << "step " << k;
    for (const double x : controller.state().qd) ASSERT_TRUE(std::isfinite(x)) << "step " << k;
    for (const auto& box : room.boxes) {
      ASSERT_TRUE(vec(box->getCenterOfMassPosition()).allFinite()) << "step " << k;
      ASSERT_TRUE(vec(box->getLinearVelocity()).allFinite()) << "step " << k;
    }
  }
  std::printf("    %d steps, %lld handovers, %lld contacts, guard fired %lld times\n", steps,
              controller.counts().handovers, controller.counts().contacts, controller.counts().guard_fired);
  EXPECT_GT(controller.counts().handovers, steps / 20);
  EXPECT_GT(controller.counts().contacts, steps / 20);
  EXPECT_EQ(controller.counts().guard_fired, 0);
}

TEST(ControllerDynamics, RefusesWhatDoesNotFit) {
  const FigureModel model = doll();
  FigureAnimation animation(model, doll_clip());
  animation.evaluate();
  Room room;
  ControllerSettings bad;
  bad.max_step = 0;
  EXPECT_THROW(ArticulatedController(room.world, animation, 1, 1, bad), Error);
  EXPECT_EQ(room.world.getNumCollisionObjects(), 0);
  ArticulatedController controller(room.world, animation);
  EXPECT_THROW(controller.hand_over(5, true), Error);
  const bool three[] = {true, true, true};
  EXPECT_THROW(controller.set_dynamic(three), Error);
  EXPECT_FALSE(controller.dynamic(0));
}

}  // namespace
}  // namespace softpoint::figure
