// Characters in a world: flight, rest, hands, handles, collisions, exoskeletons.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "softpoint/core/deformable_system.h"
#include "softpoint/elastic/character.h"
#include "support/characters.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/state_hash.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::AssemblySettings;
using elastic::Character;
using elastic::CharacterSettings;
using elastic::Hold;
using elastic::PartEnd;

CharacterSettings exact(bool inertia) {
  CharacterSettings settings;
  settings.joints = AssemblySettings::exact();
  settings.inertia = inertia;
  return settings;
}

// Bullet's own arithmetic is what is left of an error in single precision.
const double kRounding = by_precision(1e-9, 1e-5);

Mat3 lying() { return turned_about(Vec3::UnitX(), 0.3); }

TEST(Character, FallsFreelyAsARigidBody) {
  for (const auto& design : {chain_of(3), branched_figure()}) {
    TestWorld world;
    DeformableSystem system(*world);
    Character character(design, exact(true), Vec3(1, 20, 2), lying());
    system.add(character);
    const std::vector<Vec3> before(character.points().begin(), character.points().end());
    world.step(60);
    // n (n + 1) / 2 steps of g h^2.
    const Vec3 fallen(0, -9.81 / 3600.0 * 60 * 61 / 2, 0);
    for (std::size_t p = 0; p < before.size(); ++p) {
      EXPECT_LT((character.points()[p] - before[p] - fallen).norm(), 1e3 * kRounding);
      EXPECT_LT((character.velocities()[p] - Vec3(0, -9.81, 0)).norm(), 1e3 * kRounding);
    }
    EXPECT_LT(character.elastic_energy(), 1e-3 * by_precision(1e-9, 1.0));
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
}

// Linear momentum is kept to the exact dial. Of angular momentum implicit Euler takes h sum m v' x v in each
// step, of the velocities before and after: second order in the turn of a step.
TEST(Character, KeepsItsMomentumInFlight) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Character character(chain_of(4, cylinder_segment(1e6)), exact(true), Vec3(0, 5, 0));
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  const Vec3 impulse(400, 150, -80);
  character.apply_impulse(20, Vec3(0.2, 0.3, 0.5), impulse);
  world.step();
  const Vec3 linear = character.momentum(), angular = character.angular_momentum();
  EXPECT_LT((linear - impulse).norm(), 1e-7 * impulse.norm());
  EXPECT_GT(angular.norm(), 100.0);
  double worst = 0, largest_step = 0;
  Vec3 last = angular;
  for (int i = 0; i < 120; ++i) {
    world.step();
    worst = std::max(worst, (character.momentum() - linear).norm() / linear.norm());
    largest_step = std::max(largest_step, (character.angular_momentum() - last).norm() / angular.norm());
    last = character.angular_momentum();
  }
  std::printf("    120 steps: momentum off by %.2g of it, angular momentum %.2g in all, %.2g in a step\n",
              worst, (last - angular).norm() / angular.norm(), largest_step);
  EXPECT_LT(worst, 1e-8);
  EXPECT_LT((last - angular).norm(), 5e-3 * angular.norm());
  EXPECT_LT(largest_step, 2e-3);
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

TEST(Character, ComesToRestOnAFloorWhichBearsItsWeightAndSleeps) {
  TestWorld world;
  // Not a plane: as in any world but the tests', what is static may be asleep.
  world.add_box(Vec3(10, 0.5, 10), 0, Vec3(0, -0.5, 0)).forceActivationState(ISLAND_SLEEPING);
  DeformableSystem system(*world);
  CharacterSettings settings;
  settings.inertia = true;
  Character character(chain_of(2), settings, Vec3(0, 0.505, 0));
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  const double weight = 9.81 * character.total_mass();
  world.step(900);
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& c : system.contacts()) sum += c.force;
  std::printf("    after 15 s: floor bears %.6f of the weight, fastest point %.2g m/s\n", sum.y() / weight,
              character.max_speed());
  EXPECT_NEAR(sum.y() / weight, 1.0, 1e-3);
  EXPECT_LT(std::hypot(sum.x(), sum.z()), 1e-2 * weight);
  EXPECT_LT(character.max_speed(), 1e-2);
  character.forceActivationState(ACTIVE_TAG);
  world.step(240);
  ASSERT_TRUE(character.asleep());
  const std::uint64_t bits = bits_of(system);
  world.step(30);
  EXPECT_EQ(bits_of(system), bits);
  // An impulse wakes it.
  character.apply_impulse(0, Vec3(1, 0, 0), Vec3(0, 0, 500));
  world.step();
  EXPECT_FALSE(character.asleep());
  EXPECT_GT(character.max_speed(), 0.01);
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

// A limited handle: what it gives is what the character takes on, to the tolerance of the joints' linear
// response, 1e-4.
TEST(Character, AHandleOnItsSkinPullsIt) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Character character(chain_of(3), exact(true), Vec3(0, 5, 0));
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  const int point = character.assembly().point_of({0, 1, 40});
  const HandleId handle =
      system.grab(character, point, character.points()[static_cast<std::size_t>(point)] + Vec3(3, 1, 0), 400);
  Vec3 given = Vec3::Zero();
  double worst = 0;
  for (int i = 0; i < 30; ++i) {
    world.step();
    given += system.handle_force(handle) / 60.0;
    EXPECT_LE(system.handle_force(handle).norm(), 400 * (1 + 1e-9));
    worst = std::max(worst, (character.momentum() - given).norm() / given.norm());
  }
  std::printf("    momentum off by %.2g of what the handle gave\n", worst);
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(given.norm(), 100.0);
  EXPECT_GT(character.elastic_energy(), 0.0);
}

// A character held by its hands is not carried away: they bear what the handle pulls with.
TEST(Character, HandsBearWhatAHandlePulls) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Character character(chain_of(5), exact(false), Vec3(0, 5, 0));
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  character.hold({0, false}, Hold::kSurface);
  character.hold({0, true}, Hold::kPoint);
  const int point = character.assembly().point_of({0, 2, 40});
  const Vec3 from = character.points()[static_cast<std::size_t>(point)];
  const HandleId handle = system.grab(character, point, from + Vec3(0.2, 0.1, 0.05));
  world.step(120);
  const Vec3 pull = system.handle_force(handle);
  const Vec3 hands = character.end_force({0, false}) + character.end_force({0, true});
  std::printf("    handle %.4g N, hands off by %.2g of it\n", pull.norm(),
              (pull + hands).norm() / pull.norm());
  EXPECT_GT(pull.norm(), 10.0);
  EXPECT_LT((pull + hands).norm(), 1e-3 * pull.norm());
  EXPECT_LT((character.points()[static_cast<std::size_t>(point)] - from - Vec3(0.2, 0.1, 0.05)).norm(), 1e-5);
  system.release(handle);
  world.step(60);
  EXPECT_LT((character.points()[static_cast<std::size_t>(point)] - from).norm(), 1e-6);
  EXPECT_LT(character.end_force({0, false}).norm(), 1e-3 * pull.norm());
}

// Linear momentum of both is kept in every step.
TEST(Character, ARigidBallTakesTheOppositeMomentum) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Character character(chain_of(3), exact(true), Vec3(0, 0, 0));
  character.setActivationState(DISABLE_DEACTIVATION);
  system.add(character);
  btRigidBody& ball = world.add(new btSphereShape(btScalar(0.3)), 100, Vec3(1.0, 0.1, 2.5));
  ball.setLinearVelocity(btVector3(-3, 0, 0));
  const Vec3 before(-300, 0, 0);
  double worst = 0;
  for (int i = 0; i < 90; ++i) {
    world.step();
    const Vec3 sum = character.momentum() + 100.0 * to_vec(ball.getLinearVelocity());
    worst = std::max(worst, (sum - before).norm() / before.norm());
  }
  std::printf("    character takes %.3g N s of 300, sum off by %.2g\n", character.momentum().norm(), worst);
  EXPECT_GT(character.momentum().norm(), 100.0);
  EXPECT_LT(worst, 1e-4);  // the tolerance of the response
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

// A character led by its hands strikes a ball: the ball takes the impulses that the contacts report.
TEST(Character, LedByHandsItPushesABall) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Character character(chain_of(3), exact(false), Vec3(0, 0, 0));
  system.add(character);
  const PartEnd root = {0, false}, tip = {0, true};
  character.hold(root, Hold::kSurface);
  character.hold(tip, Hold::kSurface);
  btRigidBody& ball = world.add(new btSphereShape(btScalar(0.3)), 20, Vec3(0.95, 0, 1.5));
  Vec3 given = Vec3::Zero();
  for (int i = 1; i <= 60; ++i) {
    const Vec3 shift(0.02 * i, 0, 0);
    character.move(root, shift);
    character.move(tip, shift + Vec3(0, 0, 3));
    world.step();
    for (const ContactPoint& c : system.contacts()) given -= c.force / 60.0;
    ASSERT_LT((20.0 * to_vec(ball.getLinearVelocity()) - given).norm(),
              by_precision(1e-9, 1e-4) * (1.0 + given.norm()));
  }
  EXPECT_GT(to_vec(ball.getLinearVelocity()).x(), 0.9);  // at least as fast as the hands, 1.2 m/s, nearly
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

// On a cube exoskeleton: ends stay on their vertices, and the exoskeleton feels the opposite of their forces,
// so that nothing is gained or lost.
TEST(Character, OnAnExoskeletonInnerForcesBalance) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  elastic::ElasticBody cube(model_of(Shape::cube, 1e5), Vec3(0, 3, 0));
  cube.setActivationState(DISABLE_DEACTIVATION);
  system.add(cube);
  // Two vertices 0.4 m apart along z, a thin chain between.
  int from = 0, to = 0;
  for (int v = 0; v < static_cast<int>(cube.points().size()); ++v) {
    const Vec3 x = cube.points()[static_cast<std::size_t>(v)] - Vec3(0, 3, 0);
    if ((x - Vec3(0.2, 0.2, -0.2)).norm() < 1e-6) from = v;
    if ((x - Vec3(0.2, 0.2, 0.2)).norm() < 1e-6) to = v;
  }
  ASSERT_NE(from, to);
  Character character(chain_of(4, cylinder_segment(1e5, 4, 0.1, 0.05)), exact(false),
                      cube.points()[static_cast<std::size_t>(from)]);
  system.add(character);
  character.attach({0, false}, cube, from);
  character.attach({0, true}, cube, to);
  const HandleId handle =
      system.grab(cube, to, cube.points()[static_cast<std::size_t>(to)] + Vec3(0, 0, 0.1), 200);
  world.step(20);
  system.release(handle);
  const Vec3 linear = cube.momentum(), angular = cube.angular_momentum(cube.center_of_mass());
  EXPECT_GT(linear.norm(), 1.0);
  for (int i = 0; i < 60; ++i) {
    world.step();
    const std::vector<Vec3> bone = character.assembly().bone(0);
    EXPECT_LT((bone.front() - cube.points()[static_cast<std::size_t>(from)]).norm(), 1e-9);
    EXPECT_LT((bone.back() - cube.points()[static_cast<std::size_t>(to)]).norm(), 1e-9);
    EXPECT_LT((character.end_force({0, false}) + character.end_force({0, true})).norm(),
              1e-6 * character.end_force({0, true}).norm() + 1e-6);
  }
  std::printf("    exoskeleton with a character: momentum off by %.2g of it, angular momentum by %.2g\n",
              (cube.momentum() - linear).norm() / linear.norm(),
              (cube.angular_momentum(cube.center_of_mass()) - angular).norm() / angular.norm());
  EXPECT_LT((cube.momentum() - linear).norm(), 1e-7 * linear.norm());
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

}  // namespace
}  // namespace softpoint
