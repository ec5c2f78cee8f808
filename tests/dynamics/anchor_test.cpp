// Anchors: points of bodies tied to rigid bodies, kinematic and static objects, links of multibodies.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/multibodies.h"
#include "support/precision.h"
#include "support/refusal.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

std::string anchor_world(const ::testing::TestParamInfo<WorldKind>& kind) {
  const char* names[] = {"Discrete", "MultiBody", "SoftRigid", "SoftMultiBody", "Deformable"};
  return names[static_cast<int>(kind.param)];
}

class Anchor : public ::testing::TestWithParam<WorldKind> {};
INSTANTIATE_TEST_SUITE_P(Worlds, Anchor,
                         ::testing::Values(WorldKind::discrete, WorldKind::multibody, WorldKind::soft_rigid,
                                           WorldKind::soft_multibody, WorldKind::deformable),
                         anchor_world);

class LinkAnchor : public ::testing::TestWithParam<WorldKind> {};
INSTANTIATE_TEST_SUITE_P(Worlds, LinkAnchor,
                         ::testing::Values(WorldKind::multibody, WorldKind::soft_multibody,
                                           WorldKind::deformable),
                         anchor_world);

Vec3 point_of(const Deformable& body, int point) { return body.points()[static_cast<std::size_t>(point)]; }

// m, of an anchored point from its place on the object, as both stand after the step.
double miss(const Deformable& body, int point, const btCollisionObject& object, const Vec3& local) {
  return (point_of(body, point) - to_vec(object.getWorldTransform() * to_bt(local))).norm();
}

struct Totals {
  Vec3 linear, angular;
};

Totals totals_of(const Deformable& body, const std::vector<btRigidBody*>& cubes) {
  Totals t{body.momentum(), body.angular_momentum()};
  for (const btRigidBody* cube : cubes) {
    const Vec3 p = to_vec(cube->getLinearVelocity()) / double(cube->getInvMass());
    t.linear += p;
    t.angular += to_vec(cube->getWorldTransform().getOrigin()).cross(p) +
                 to_vec(cube->getAngularVelocity()) / double(cube->getInvInertiaDiagLocal().x());
  }
  return t;
}

// Cubes: Bullet's own integration keeps their angular momentum exactly.
TEST_P(Anchor, KeepsMomentumOfBodyAndRigidBodies) {
  for (const double young : {1e5, 1e7}) {
    for (const double max_force : {std::numeric_limits<double>::infinity(), 300.0}) {
      TestWorld world(GetParam());
      world->setGravity(btVector3(0, 0, 0));
      DeformableSystem system(*world);
      ElasticBody body(model_of(Shape::part, young), Vec3(0.1, 0.2, 0));
      body.set_velocity(Vec3(0.5, 0, 0.2), Vec3(1, 2, 0));
      system.add(body);
      std::vector<btRigidBody*> cubes = {&world.add_box(Vec3::Constant(0.1), 8, Vec3(0.5, 0.3, 0.1)),
                                         &world.add_box(Vec3::Constant(0.15), 30, Vec3(-0.5, 0.1, 0))};
      cubes[0]->setIgnoreCollisionCheck(cubes[1], true);  // Bullet's own contacts shift positions
      cubes[0]->setLinearVelocity(btVector3(0, 3, 1));
      cubes[0]->setAngularVelocity(btVector3(2, -1, 4));
      cubes[1]->setAngularVelocity(btVector3(0, 3, 0));
      system.attach(body, 5, *cubes[0], max_force);
      system.attach(body, 40, *cubes[0], max_force);
      system.attach(body, 20, *cubes[1], max_force);
      const double scale = body.total_mass() * 1.0;
      double worst_linear = 0, worst_angular = 0;
      Totals before = totals_of(body, cubes);
      for (int i = 0; i < 120; ++i) {
        world.step();
        const Totals after = totals_of(body, cubes);
        worst_linear = std::max(worst_linear, (after.linear - before.linear).norm() / scale);
        worst_angular = std::max(worst_angular, (after.angular - before.angular).norm() / scale);
        before = after;
      }
      std::printf(
          "    E %.0e, force %g: a step changes momentum by %.1e, angular momentum by %.1e of the scale\n",
          young, max_force, worst_linear, worst_angular);
      EXPECT_LE(worst_linear, by_precision(1e-13, 1e-5));
      EXPECT_LE(worst_angular, by_precision(1e-13, 1e-5));
      EXPECT_EQ(system.profile().totals.guard_fired, 0);
    }
  }
}

TEST_P(Anchor, HoldsSeveralPointsOnATumblingBox) {
  for (const double young : {1e5, 1e7, 1e9}) {
    TestWorld world(GetParam());
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, young), Vec3(0, 2, 0));
    system.add(body);
    btRigidBody& box = world.add_box(Vec3(0.2, 0.1, 0.3), 20, Vec3(0.2, 1.6, 0));
    box.setAngularVelocity(btVector3(3, 5, -4));
    std::vector<Vec3> locals;
    for (int v = 0; v < 17; ++v) {  // the bottom cap and its centre
      locals.push_back(to_vec(box.getWorldTransform().inverse() * to_bt(point_of(body, v))));
      system.attach(body, v, box);
    }
    system.grab(body, 60, point_of(body, 60));
    double worst = 0;
    int iterations = 0;
    for (int i = 0; i < 180; ++i) {
      world.step();
      iterations = std::max(iterations, system.profile().counts.iterations);
      for (int v = 0; v < 17; ++v)
        worst = std::max(worst, miss(body, v, box, locals[static_cast<std::size_t>(v)]));
    }
    std::printf("    E %.0e: 17 anchors and a pin miss by %.1e m, at most %d sweeps a step\n", young, worst,
                iterations);
    EXPECT_LE(worst, by_precision(1e-6, 5e-6));
    EXPECT_EQ(system.profile().counts.anchors, 17);
    EXPECT_EQ(system.profile().counts.handles, 18);
  }
}

TEST_P(Anchor, CarriesTheWeightOfWhatHangsOnIt) {
  TestWorld world(GetParam());
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  std::vector<int> top, bottom;
  for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
    if (point_of(body, v).y() > 2.19) top.push_back(v);
    if (point_of(body, v).y() < 1.81) bottom.push_back(v);
  }
  btRigidBody& box = world.add_box(Vec3(0.2, 0.1, 0.2), 25, Vec3(0, 1.7, 0));
  std::vector<HandleId> anchors, pins;
  for (const int v : top) pins.push_back(system.grab(body, v, point_of(body, v)));
  for (const int v : bottom) anchors.push_back(system.attach(body, v, box));
  world.step(600);
  Vec3 pull = Vec3::Zero(), hold = Vec3::Zero();
  for (int i = 0; i < 60; ++i) {
    world.step();
    for (const HandleId a : anchors) pull += system.handle_force(a) / 60;
    for (const HandleId p : pins) hold += system.handle_force(p) / 60;
  }
  EXPECT_NEAR(-pull.y() / (25 * 9.81), 1.0, 1e-3);
  EXPECT_NEAR(hold.y() / ((25 + body.total_mass()) * 9.81), 1.0, 1e-3);
}

TEST_P(Anchor, FollowsStaticAndKinematicObjects) {
  TestWorld world(GetParam());
  btRigidBody& post = world.add_box(Vec3(0.1, 1, 0.1), 0, Vec3(-1, 2, 0));
  btRigidBody& crank = world.add_box(Vec3(0.5, 0.05, 0.05), 0, Vec3(0.5, 2, 0));
  crank.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::bar, 1e5), Vec3(-0.45, 2, 0));
  system.add(body);
  int left = 0, right = 0;
  for (int v = 0; v < static_cast<int>(body.points().size()); ++v) {
    if (point_of(body, v).x() < point_of(body, left).x()) left = v;
    if (point_of(body, v).x() > point_of(body, right).x()) right = v;
  }
  const Vec3 on_post = to_vec(post.getWorldTransform().inverse() * to_bt(point_of(body, left)));
  const Vec3 on_crank = to_vec(crank.getWorldTransform().inverse() * to_bt(point_of(body, right)));
  system.attach(body, left, post);
  system.attach(body, right, crank, on_crank);
  double worst = 0;
  for (int i = 1; i <= 240; ++i) {
    crank.setWorldTransform(btTransform(btQuaternion(btVector3(0, 0, 1), btScalar(std::sin(0.05 * i))),
                                        btVector3(btScalar(0.5), 2, 0)));
    world.step();
    worst = std::max({worst, miss(body, left, post, on_post), miss(body, right, crank, on_crank)});
  }
  std::printf("    anchors on a post and a crank miss by %.1e m\n", worst);
  EXPECT_LE(worst, by_precision(1e-6, 5e-6));
}

TEST_P(LinkAnchor, HoldsOnTwoLinksOfAChain) {
  for (const bool fixed : {true, false}) {
    TestWorld world(GetParam());
    if (!fixed) world->setGravity(btVector3(0, 0, 0));
    Multibodies multibodies(world);
    btMultiBody& chain = multibodies.add_chain(
        {.links = 3, .fixed_base = fixed, .base = Vec3(0, 2, 0), .joint = ChainSettings::Joint::ball});
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, 1e6), Vec3(1.3, 1.6, 0));
    if (!fixed) body.set_velocity(Vec3(1, -1, 0.5), Vec3(0, 1, 1));
    system.add(body);
    btMultiBodyLinkCollider& hand = *chain.getLinkCollider(2);
    btMultiBodyLinkCollider& elbow = *chain.getLinkCollider(1);
    std::vector<std::pair<int, Vec3>> on_hand, on_elbow;
    for (const int v : {3, 7}) {
      on_hand.emplace_back(v, to_vec(hand.getWorldTransform().inverse() * to_bt(point_of(body, v))));
      system.attach(body, v, hand);
    }
    on_elbow.emplace_back(70, to_vec(elbow.getWorldTransform().inverse() * to_bt(point_of(body, 70))));
    system.attach(body, 70, elbow);
    double worst = 0;
    for (int i = 0; i < 180; ++i) {
      world.step();
      for (const auto& [v, local] : on_hand) worst = std::max(worst, miss(body, v, hand, local));
      for (const auto& [v, local] : on_elbow) worst = std::max(worst, miss(body, v, elbow, local));
    }
    std::printf("    %s base: anchors on two links miss by %.1e m\n", fixed ? "fixed" : "free", worst);
    EXPECT_LE(worst, by_precision(1e-6, 1e-5));
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
}

TEST_P(Anchor, NeverPullsHarderThanItsLimit) {
  TestWorld world(GetParam());
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  btRigidBody& box = world.add_box(Vec3::Constant(0.1), 200, Vec3(0, 1, 0));
  for (int v = 0; v < 26; ++v) system.grab(body, v, point_of(body, v));
  const HandleId anchor = system.attach(body, 3, box, 500.0);
  double strongest = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    strongest = std::max(strongest, system.handle_force(anchor).norm());
  }
  EXPECT_LE(strongest, 500 * (1 + 1e-9));
  EXPECT_GT(strongest, 499);
  // 200 kg fall against 500 N.
  EXPECT_NEAR(double(box.getLinearVelocity().y()), -(9.81 - 2.5), 0.2);
}

TEST_P(Anchor, BodyAndObjectDoNotCollideWhileItHolds) {
  TestWorld world(GetParam());
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
  system.add(body);
  btRigidBody& box = world.add_box(Vec3::Constant(0.2), 20, Vec3(0, 0.35, 0));  // 5 cm inside the body
  btRigidBody& other = world.add_box(Vec3::Constant(0.2), 20, Vec3(0, -0.35, 0));
  const HandleId first = system.attach(body, 0, box), second = system.attach(body, 1, box);
  body.setIgnoreCollisionCheck(&other, true);  // the application's own
  const HandleId third = system.attach(body, 2, other);
  world.step(30);
  EXPECT_TRUE(system.contacts().empty());
  system.release(first);
  system.release(third);
  world.step(2);
  EXPECT_TRUE(system.contacts().empty()) << "one anchor still holds, the application forbids the other pair";
  system.release(second);
  world.step(1);
  EXPECT_FALSE(system.contacts().empty());
}

TEST_P(Anchor, LeavesCollisionsAloneIfAsked) {
  TestWorld world(GetParam());
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
  system.add(body);
  btRigidBody& box = world.add_box(Vec3::Constant(0.2), 20, Vec3(0, 0.35, 0));
  system.attach(body, 0, box, 100.0, true);
  world.step(1);
  EXPECT_FALSE(system.contacts().empty());
}

TEST_P(Anchor, GoesWithItsObject) {
  TestWorld world(GetParam());
  DeformableSystem system(*world);
  auto body = std::make_unique<ElasticBody>(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(*body);
  btRigidBody& kept = world.add_box(Vec3::Constant(0.1), 0, Vec3(0, 3, 0));
  btRigidBody& doomed = world.add_box(Vec3::Constant(0.1), 10, Vec3(0, 1.5, 0));
  const HandleId to_kept = system.attach(*body, 0, kept);
  const HandleId to_doomed = system.attach(*body, 1, doomed), also = system.attach(*body, 2, doomed, 100.0);
  world.step(5);
  world.erase(doomed);                   // deleted
  EXPECT_TRUE(system.holds(to_doomed));  // until the next step looks
  world.step(1);
  EXPECT_FALSE(system.holds(to_doomed));
  EXPECT_FALSE(system.holds(also));
  EXPECT_TRUE(system.holds(to_kept));
  EXPECT_EQ(system.profile().totals.anchors_released, 2);
  expect_refusal([&] { system.handle_force(to_doomed); }, {"handle", "unknown"});
  world.step(60);
  EXPECT_LT(miss(*body, 0, kept, to_vec(kept.getWorldTransform().inverse() * to_bt(point_of(*body, 0)))),
            by_precision(1e-9, 1e-6));
  body.reset();
  EXPECT_FALSE(system.holds(to_kept));
  world.step(5);
}

TEST_P(Anchor, MovesOverItsObject) {
  TestWorld world(GetParam());
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0));
  system.add(body);
  btRigidBody& box = world.add_box(Vec3::Constant(0.2), 0, Vec3(1, 2, 0));
  const HandleId anchor = system.attach(body, 4, box, Vec3(-0.2, 0, 0));
  world.step(30);
  system.move(anchor, Vec3(-0.2, 0.1, 0.05));
  world.step(2);
  EXPECT_LT(miss(body, 4, box, Vec3(-0.2, 0.1, 0.05)), 1e-6);
}

TEST(AnchorRefusal, NamesWhatIsWrongAndChangesNothing) {
  TestWorld world, elsewhere;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 2, 0)),
      outside(model_of(Shape::cube, 1e6), Vec3(3, 2, 0)), soft(model_of(Shape::cube, 1e6), Vec3(6, 2, 0));
  system.add(body);
  system.add(soft);
  btRigidBody& box = world.add_box(Vec3::Constant(0.1), 5, Vec3(0, 3, 0));
  btRigidBody& foreign = elsewhere.add_box(Vec3::Constant(0.1), 5, Vec3(0, 3, 0));
  const double nan = std::nan("");
  expect_refusal([&] { system.attach(outside, 0, box); }, {"attach", "not in this system"});
  expect_refusal([&] { system.attach(body, 26, box); }, {"attach: point", "26"});
  expect_refusal([&] { system.attach(body, -1, box, Vec3::Zero()); }, {"attach: point", "-1"});
  expect_refusal([&] { system.attach(body, 0, box, Vec3(0, nan, 0)); }, {"attach: local", "nan"});
  expect_refusal([&] { system.attach(body, 0, box, 0.0); }, {"attach: max_force", "0", "> 0"});
  expect_refusal([&] { system.attach(body, 0, foreign); }, {"attach", "not in the world"});
  expect_refusal([&] { system.attach(body, 0, soft); }, {"attach", "soft body"});
  world.step(1);
  EXPECT_EQ(system.profile().counts.handles, 0);
  EXPECT_TRUE(body.checkCollideWith(&box));
}

}  // namespace
}  // namespace softpoint
