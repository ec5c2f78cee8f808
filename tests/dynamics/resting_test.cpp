// Things at rest: boxes on bodies, bodies on the floor, piles; speeds, forces and the energy of settling.
#include <gtest/gtest.h>

#include <cmath>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/penetration.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

struct LoadedCube {
  double young;
  double half;  // m, of the box
  double mass;  // kg
  Vec3 offset;  // m, of the box from the middle
  Shape shape;
  double settle;  // s
};

void PrintTo(const LoadedCube& c, std::ostream* out) {
  *out << "E " << c.young << " Pa, box of " << 2 * c.half << " m and " << c.mass << " kg at "
       << c.offset.transpose();
}

class RestingBox : public ::testing::TestWithParam<LoadedCube> {};

TEST_P(RestingBox, HasNoVerticalSpeedAndItsWeightIsReadable) {
  const LoadedCube& c = GetParam();
  TestWorld world;
  btRigidBody& floor = world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(c.shape, c.young), Vec3(0, c.shape == Shape::cube ? 0.202 : 0.252, 0),
                   c.shape == Shape::part
                       ? Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitX()).toRotationMatrix()
                       : Mat3(Mat3::Identity()));
  system.add(body);
  const double top = c.shape == Shape::cube ? 0.402 : 0.502;
  btRigidBody& box =
      world.add_box(Vec3::Constant(c.half), c.mass, Vec3(0, top + c.half + 0.005, 0) + c.offset);
  world.step(static_cast<int>(60 * c.settle));
  double fastest = 0;
  Vec3 on_box = Vec3::Zero(), on_floor = Vec3::Zero();
  const int watched = 300;
  for (int i = 0; i < watched; ++i) {
    world.step();
    fastest = std::max(fastest, std::abs(double(box.getLinearVelocity().y())));
    for (const ContactPoint& p : system.contacts()) {
      if (p.other == &box) on_box -= p.force / watched;
      if (p.other == &floor) on_floor -= p.force / watched;
    }
  }
  const double weight = c.mass * 9.81, all = weight + body.total_mass() * 9.81;
  std::printf(
      "    E %.0e, %4.0f kg, half %.2f: max |vy| %.1e m/s; force on box %.5f, on floor %.5f of the weight\n",
      c.young, c.mass, c.half, fastest, on_box.y() / weight, -on_floor.y() / all);
  EXPECT_LE(fastest, 1e-3);
  EXPECT_NEAR(on_box.y() / weight, 1.0, 1e-3);
  EXPECT_NEAR(-on_floor.y() / all, 1.0, 1e-3);
  EXPECT_LT(skin_depth(body, box), 1e-3);
  EXPECT_LT(corner_depth(body, box), 2e-3);
  EXPECT_LT(skin_depth(body, floor), 1e-3);
  EXPECT_NEAR(box.getWorldTransform().getOrigin().x(), c.offset.x(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Cases, RestingBox,
                         ::testing::Values(LoadedCube{1e5, 0.1, 5, Vec3::Zero(), Shape::cube, 8},
                                           LoadedCube{1e5, 0.1, 50, Vec3::Zero(), Shape::cube, 12},
                                           LoadedCube{1e5, 0.06, 2, Vec3(0.03, 0, 0.02), Shape::cube, 8},
                                           LoadedCube{1e6, 0.1, 20, Vec3::Zero(), Shape::cube, 5},
                                           LoadedCube{1e6, 0.15, 50, Vec3(0.02, 0, 0), Shape::cube, 5},
                                           LoadedCube{1e6, 0.3, 20, Vec3::Zero(), Shape::cube, 5},
                                           LoadedCube{1e7, 0.1, 5, Vec3(0.05, 0, -0.03), Shape::cube, 5},
                                           LoadedCube{1e7, 0.1, 200, Vec3::Zero(), Shape::cube, 5},
                                           LoadedCube{1e5, 0.1, 5, Vec3::Zero(), Shape::part, 8},
                                           LoadedCube{1e6, 0.1, 20, Vec3(0.02, 0, 0.05), Shape::part, 5},
                                           LoadedCube{1e7, 0.2, 50, Vec3::Zero(), Shape::part, 5}));

TEST(RestingBody, ContactForcesCarryTheWeight) {
  for (const Shape shape : {Shape::cube, Shape::ball, Shape::part}) {
    for (const double young : {1e5, 1e6}) {
      TestWorld world;
      world.add_floor();
      DeformableSystem system(*world);
      ElasticBody body(model_of(shape, young), Vec3(0, 0.305, 0));
      body.setActivationState(DISABLE_DEACTIVATION);
      system.add(body);
      world.step(1800);  // a prism on its side rocks for long
      Vec3 force = Vec3::Zero();
      for (const ContactPoint& p : system.contacts()) {
        force += p.force;
        EXPECT_GE(p.force.dot(p.normal), 0.0);
      }
      EXPECT_NEAR(force.y() / (9.81 * body.total_mass()), 1.0, 1e-3) << "E " << young;
      EXPECT_LT(std::hypot(force.x(), force.z()), 1e-3 * force.y()) << "E " << young;
    }
  }
}

TEST(RestingBody, ReadableGapIsTheGap) {
  for (const int passes : {4, 1}) {
    TestWorld world;
    btRigidBody& floor = world.add_floor();
    DeformableSystem system(*world, ContactSettings{.max_passes = passes});
    ElasticBody body(model_of(Shape::ball), Vec3(0, 0.32, 0));
    system.add(body);
    for (int i = 0; i < 60; ++i) {
      world.step();
      for (const ContactPoint& p : system.contacts()) {
        const double gap = brute_distance(*floor.getCollisionShape(), floor.getWorldTransform(), p.point);
        ASSERT_NEAR(p.gap, gap, 1e-6) << "step " << i << ", " << passes << " passes";
      }
    }
  }
}

// Bullet puts still objects to sleep; waking and sleeping must not make them hop.
TEST(RestingBox, MayFallAsleep) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  btRigidBody& box = world.add_box(Vec3(0.1, 0.1, 0.1), 5.0, Vec3(0, 0.51, 0));
  btRigidBody& upper = world.add_box(Vec3(0.05, 0.05, 0.05), 1.0, Vec3(0, 0.67, 0));
  box.forceActivationState(ACTIVE_TAG);
  upper.forceActivationState(ACTIVE_TAG);
  world.step(180);
  double low = 1e9, high = -1e9, fastest = 0;
  for (int i = 0; i < 600; ++i) {
    world.step();
    low = std::min(low, double(box.getWorldTransform().getOrigin().y()));
    high = std::max(high, double(box.getWorldTransform().getOrigin().y()));
    fastest = std::max(fastest, std::abs(double(box.getLinearVelocity().y())));
  }
  EXPECT_LT(high - low, 1e-3);
  EXPECT_LT(fastest, 1e-3);
}

// A tower of light rigid boxes under a heavy body stands: the load goes through it to the floor.
TEST(RestingBody, OnAPileOfBoxes) {
  TestWorld world;
  world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
  btRigidBody& lower = world.add_box(Vec3(0.2, 0.1, 0.2), 10, Vec3(0, 0.1, 0));
  btRigidBody& upper = world.add_box(Vec3(0.2, 0.1, 0.2), 10, Vec3(0, 0.3, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.602, 0));
  system.add(body);
  world.step(300);
  double fastest = 0;
  for (int i = 0; i < 300; ++i) {
    world.step();
    fastest = std::max({fastest, std::abs(double(lower.getLinearVelocity().y())),
                        std::abs(double(upper.getLinearVelocity().y()))});
  }
  std::printf("    max |vy| of the pile %.1e m/s\n", fastest);
  EXPECT_LT(fastest, 2e-2);
  EXPECT_NEAR(lower.getWorldTransform().getOrigin().y(), 0.1, 1e-3);
  EXPECT_NEAR(upper.getWorldTransform().getOrigin().y(), 0.3, 1e-3);
  EXPECT_NEAR(body.center_of_mass().y(), 0.6, 5e-3);
  EXPECT_NEAR(body.center_of_mass().x(), 0.0, 5e-3);
}

}  // namespace
}  // namespace softpoint
