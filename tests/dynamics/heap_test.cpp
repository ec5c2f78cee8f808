// A step takes nothing from the heap once it is warm. An executable of its own: it replaces malloc.
#include <LinearMath/btAlignedAllocator.h>
#include <gtest/gtest.h>
#include <Eigen/Core>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "softpoint/core/deformable_system.h"
#include "softpoint/elastic/character.h"
#include "support/characters.h"
#include "support/counted_malloc.h"
#include "support/elastic_bodies.h"
#include "support/multibodies.h"
#include "support/spring_net.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;
using test::heap_calls;

void* counted_bullet(std::size_t size) {
  ++heap_calls;
  return std::malloc(size);
}
void freed_bullet(void* p) { std::free(p); }

// Heap calls of `steps` world steps, C++ and Bullet's together.
long long heap_calls_of(TestWorld& world, int steps) {
  btAlignedAllocSetCustom(&counted_bullet, &freed_bullet);
  const long long before = heap_calls;
  world.step(steps);
  const long long after = heap_calls;
  btAlignedAllocSetCustom(nullptr, nullptr);
  return after - before;
}

TEST(Counter, SeesWhatEigenTakes) {
  if (kInstrumented) GTEST_SKIP() << "sanitizers replace malloc";
  const long long before = heap_calls;
  const Eigen::VectorXd taken =
      Eigen::VectorXd::Constant(::testing::UnitTest::GetInstance()->total_test_count() + 100, 1.0);
  EXPECT_GT(taken.sum(), 0.0);
  EXPECT_EQ(heap_calls, before + 1);
}

TEST(Step, TakesNothingFromTheHeapAtRest) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball), Vec3(0, 0.305, 0)),
      other(model_of(Shape::cube, 1e6), Vec3(2, 0.202, 0));
  system.add(body);
  system.add(other);
  world.add_box(Vec3(0.1, 0.1, 0.1), 5, Vec3(2, 0.51, 0));
  world.step(300);
  EXPECT_FALSE(system.contacts().empty());
  EXPECT_EQ(heap_calls_of(world, 120), 0);
}

TEST(Step, TakesNothingFromTheHeapAsleepAndAtWaking) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(2, 0.202, 0));
  system.add(body);
  world.add_box(Vec3(0.1, 0.1, 0.1), 5, Vec3(2, 0.51, 0)).forceActivationState(ACTIVE_TAG);
  const HandleId handle = system.grab(body, 0, body.points()[0], 1.0);
  world.step(600);
  ASSERT_TRUE(body.asleep());
  EXPECT_EQ(heap_calls_of(world, 120), 0);
  for (const bool counting : {false, true}) {
    system.move(handle, body.points()[0] + Vec3(counting ? 0.01 : 0.02, 0, 0));
    const long long calls = heap_calls_of(world, 600);  // waking, coming to rest, falling asleep
    ASSERT_TRUE(body.asleep());
    EXPECT_EQ(counting ? calls : 0, 0);
  }
}

TEST(Snapshot, SavingAndRestoringAgainTakeNothingFromTheHeap) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  system.grab(body, 0, body.points()[0], 1.0);
  world.step(30);
  Snapshot snapshot = system.save();
  world.step(30);
  const long long before = heap_calls;
  system.restore(snapshot);
  system.save(snapshot);
  EXPECT_EQ(heap_calls - before, 0);
  EXPECT_GT(snapshot.bytes().size(), 26u * 6 * 8);
}

TEST(Step, TakesNothingFromTheHeapInMotion) {
  TestWorld world, twin;
  for (TestWorld* w : {&world, &twin}) {
    w->add_box(Vec3(2, 0.5, 2), 0, Vec3(0, -0.5, 0));
  }
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball), Vec3(0, 0.4, 0));
  system.add(body);
  world.add_box(Vec3(0.15, 0.1, 0.15), 5, Vec3(0.5, 0.1, 0));
  twin.add_box(Vec3(0.15, 0.1, 0.15), 5, Vec3(0.5, 0.1, 0));
  const HandleId handle = system.grab(body, 10, body.points()[10], 3000);
  // The same stirring twice: warm up with the first.
  long long calls = 0;
  for (const bool counting : {false, false, true}) {
    for (int i = 0; i < 240; ++i) {
      const double t = 2 * std::numbers::pi * i / 240;
      system.move(handle, Vec3(0.5 * std::cos(t), 0.25 + 0.2 * std::sin(2 * t), 0.3 * std::sin(t)));
      if (counting) {
        calls += heap_calls_of(world, 1);
      } else {
        world.step();
      }
    }
  }
  twin.step(480);
  const long long bullets_own = heap_calls_of(twin, 240);
  std::printf("    %lld heap calls in 240 steps in motion, %lld in a twin world without us\n", calls,
              bullets_own);
  EXPECT_LE(calls, bullets_own);
}

TEST(Step, TakesNothingFromTheHeapWithPointLoads) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.25, 0));
  system.add(body);
  system.grab(body, 3, body.points()[3], 100.0);
  SpringNet net(body, {0, 5, 11, 20, 25}, 1e4 * Eigen::MatrixXd::Identity(15, 15));
  body.setActivationState(DISABLE_DEACTIVATION);
  long long setting = 0, stepping = 0;
  for (int i = 0; i < 480; ++i) {
    net.update(body);
    if (i % 16 == 0) body.clear_point_loads();
    const long long before = heap_calls;
    body.set_point_loads(net.points, net.forces, {net.stiffness.data(), 225});
    setting += i == 0 ? 0 : heap_calls - before;
    const long long calls = heap_calls_of(world, 1);
    stepping += i < 240 ? 0 : calls;  // contacts have come to rest
  }
  EXPECT_FALSE(system.contacts().empty());
  EXPECT_EQ(setting, 0);
  EXPECT_EQ(stepping, 0);
}

// A free chain tied to a body and pushed about by it, another anchored to a box; the twin is the same without
// bodies of ours (Bullet's multibody solver itself may allocate).
TEST(Step, TakesNothingFromTheHeapWithMultibodiesAndAnchors) {
  for (const WorldKind kind : {WorldKind::multibody, WorldKind::deformable}) {
    TestWorld world(kind), twin(kind);
    Multibodies multibodies(world), twins(twin);
    btMultiBody* chain = nullptr;
    btRigidBody* box = nullptr;
    for (TestWorld* w : {&twin, &world}) {
      w->add_box(Vec3(3, 0.5, 3), 0, Vec3(0, -0.5, 0));
      box = &w->add_box(Vec3::Constant(0.1), 5, Vec3(1.2, 0.8, 0));
      Multibodies& mine = w == &world ? multibodies : twins;
      chain = &mine.add_chain(
          {.links = 3, .base = Vec3(-0.9, 0.9, 0), .joint = ChainSettings::Joint::ball, .gap = 0.1});
      mine.add_chain({.links = 2, .fixed_base = false, .base = Vec3(0, 0.1, 1)});
    }
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::ball), Vec3(0.2, 0.4, 0)),
        other(model_of(Shape::cube, 1e6), Vec3(0.3, 0.5, 1));
    system.add(body);
    system.add(other);
    system.attach(body, 0, *chain->getLinkCollider(2));
    system.attach(body, 50, *chain->getLinkCollider(2), 500.0);
    system.attach(body, 100, *box);
    const HandleId handle = system.grab(body, 10, body.points()[10], 3000);
    long long calls = 0;
    for (const bool counting : {false, false, false, true}) {
      for (int i = 0; i < 240; ++i) {
        const double t = 2 * std::numbers::pi * i / 240;
        system.move(handle, Vec3(0.3 * std::cos(t), 0.4 + 0.2 * std::sin(2 * t), 0.3 * std::sin(t)));
        if (counting) {
          calls += heap_calls_of(world, 1);
        } else {
          world.step();
        }
      }
    }
    bool on_link = false;
    for (const ContactPoint& c : system.contacts()) {
      on_link |= btMultiBodyLinkCollider::upcast(c.other) != nullptr;
    }
    EXPECT_TRUE(on_link);
    twin.step(720);
    const long long bullets_own = heap_calls_of(twin, 240);
    std::printf("    %lld heap calls in 240 steps with multibodies, %lld in a twin world without us\n", calls,
                bullets_own);
    EXPECT_LE(calls, bullets_own);
    EXPECT_EQ(system.profile().totals.guard_fired, 0);
  }
}

TEST(Solve, OfAnAssemblyTakesNothingFromTheHeap) {
  for (const bool exact : {false, true}) {
    elastic::Assembly figure(branched_figure(1e5, {1e4, 500, 0, 0}),
                             exact ? elastic::AssemblySettings::exact() : elastic::AssemblySettings{});
    figure.hold({0, false}, elastic::Hold::kSurface);
    figure.hold({1, true}, elastic::Hold::kPoint);
    long long before = 0;
    for (int i = 0; i < 40; ++i) {
      if (i == 10) before = heap_calls;
      figure.move({1, true}, Vec3(2.5 - 0.02 * i, 0.03 * i, 0.6 * (i % 2)));  // far: inverse kinematics too
      figure.push({2, 1, 30}, Vec3(10.0 * i, 0, 5));
      figure.set_gravity(Vec3(0, 0, -0.1 * i));
      figure.solve();
      if (i % 5 == 0) figure.clear_pushes();
    }
    EXPECT_EQ(heap_calls - before, 0) << (exact ? "exact" : "default");
  }
}

TEST(Step, OfCharactersTakesNothingFromTheHeap) {
  for (const bool inertia : {false, true}) {
    TestWorld world;
    world.add_floor();
    DeformableSystem system(*world);
    elastic::CharacterSettings settings;
    settings.inertia = inertia;
    // Between hands above the floor, by itself on it.
    elastic::Character character(chain_of(1), settings, Vec3(0, inertia ? 0.52 : 1.5, 0));
    character.setActivationState(DISABLE_DEACTIVATION);
    system.add(character);
    if (!inertia) {
      character.hold({0, false}, elastic::Hold::kPoint);
      character.hold({0, true}, elastic::Hold::kPoint);
    }
    const HandleId handle = system.grab(character, 60, character.points()[60] + Vec3(0.05, 0.05, 0), 500);
    world.step(90);
    EXPECT_EQ(heap_calls_of(world, 30), 0) << (inertia ? "inertia" : "hands");
    EXPECT_TRUE(system.holds(handle));
  }
}

}  // namespace
}  // namespace softpoint
