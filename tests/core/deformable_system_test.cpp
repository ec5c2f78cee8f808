// The seam by itself, with free particles as the deformable: refusals, the guard, warm starts.
#include "softpoint/core/deformable_system.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "support/particles.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kBad[] = {kNan, kInfinity, -kInfinity};

TEST(Refusals, OfContactSettings) {
  struct Row {
    const char* field;
    std::function<void(ContactSettings&, double)> set;
    std::vector<double> bad;
  };
  const Row rows[] = {
      {"margin",
       [](ContactSettings& s, double x) { s.margin = x; },
       {kNan, kInfinity, -kInfinity, -1e-3, 0, 1e-6, 0.2, 1e300}},
      {"tolerance",
       [](ContactSettings& s, double x) { s.tolerance = x; },
       {kNan, kInfinity, -kInfinity, -1e-6, 0, 1.0, 1e300}},
      {"max_iterations",
       [](ContactSettings& s, double x) { s.max_iterations = int(x); },
       {0, -1, 1e6, -2147483648.0}},
      {"max_passes", [](ContactSettings& s, double x) { s.max_passes = int(x); }, {0, -5, 1000}},
      {"rebound_speed",
       [](ContactSettings& s, double x) { s.rebound_speed = x; },
       {kNan, kInfinity, -kInfinity, -0.1}},
  };
  TestWorld world;
  btConstraintSolver* solver = world->getConstraintSolver();
  for (const Row& row : rows) {
    for (const double bad : row.bad) {
      ContactSettings settings;
      row.set(settings, bad);
      expect_refusal([&] { check(settings); }, {"ContactSettings", row.field, "permitted"});
      expect_refusal([&] { DeformableSystem system(*world, settings); }, {row.field});
      EXPECT_EQ(world->getConstraintSolver(), solver);
      DeformableSystem system(*world);
      const double margin = system.settings().margin;
      expect_refusal([&] { system.set_settings(settings); }, {row.field});
      EXPECT_EQ(system.settings().margin, margin);
      EXPECT_EQ(system.settings().max_iterations, ContactSettings().max_iterations);
    }
  }
  EXPECT_NO_THROW(check(ContactSettings()));
}

TEST(Refusals, OfHandlesRaysAndImpulses) {
  TestWorld world;
  DeformableSystem system(*world);
  Particles body = Particles::tetrahedron(Vec3(0, 1, 0)), stranger = Particles::tetrahedron(Vec3(2, 1, 0));
  system.add(body);
  expect_refusal([&] { system.add(body); }, {"add"});
  expect_refusal([&] { system.remove(stranger); }, {"remove"});
  expect_refusal([&] { system.grab(stranger, 0, Vec3::Zero()); }, {"grab"});
  for (const int point : {-1, 4, 1000000}) {
    expect_refusal([&] { system.grab(body, point, Vec3::Zero()); }, {"grab", "point", "0 to 3"});
  }
  for (const double bad : kBad) {
    for (int k = 0; k < 3; ++k) {
      Vec3 v = Vec3::Zero();
      v[k] = bad;
      expect_refusal([&] { system.grab(body, 0, v); }, {"grab", "target"});
      expect_refusal([&] { system.pick(v, Vec3::Ones()); }, {"pick", "from"});
      expect_refusal([&] { system.pick(Vec3::Ones(), v); }, {"pick", "to"});
      expect_refusal([&] { body.apply_impulse(0, Vec3::Constant(1.0 / 3), v); },
                     {"apply_impulse", "impulse"});
      expect_refusal([&] { body.apply_impulse(0, v, Vec3::Zero()); }, {"apply_impulse", "weights"});
      expect_refusal([&] { body.set_acceleration(v); }, {"set_acceleration"});
    }
  }
  for (const double bad : {kNan, -kInfinity, -1.0, 0.0, -0.0}) {
    expect_refusal([&] { system.grab(body, 0, Vec3::Zero(), bad); }, {"grab", "max_force"});
  }
  for (const int face : {-1, 4}) {
    expect_refusal([&] { body.apply_impulse(face, Vec3::Constant(1.0 / 3), Vec3::Zero()); },
                   {"apply_impulse", "face"});
  }
  expect_refusal([&] { body.apply_impulse(0, Vec3::Ones(), Vec3::Zero()); }, {"apply_impulse", "weights"});
  expect_refusal([&] { body.apply_impulse(0, Vec3::Zero(), Vec3::Zero()); }, {"apply_impulse", "weights"});
  const HandleId handle = system.grab(body, 0, Vec3(0, 1, 0));
  expect_refusal([&] { system.move(handle, Vec3(kNan, 0, 0)); }, {"move", "target"});
  for (const HandleId unknown : {HandleId(0), HandleId(-1), handle + 1}) {
    expect_refusal([&] { system.move(unknown, Vec3::Zero()); }, {"move", "handle"});
    expect_refusal([&] { system.release(unknown); }, {"release", "handle"});
    expect_refusal([&] { (void)system.handle_force(unknown); }, {"handle_force", "handle"});
  }
  system.release(handle);
  expect_refusal([&] { system.release(handle); }, {"release", "handle"});
  // Nothing of all this has had an effect.
  world->setGravity(btVector3(0, 0, 0));
  const std::vector<Vec3> before(body.points().begin(), body.points().end());
  world.step(10);
  for (std::size_t v = 0; v < before.size(); ++v) {
    EXPECT_EQ(body.points()[v], before[v]);
  }
}

TEST(Refusals, OfDeformables) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Triangle> faces{{0, 1, 2}};
  expect_refusal([&] { Particles({}, faces, 1); }, {"point"});
  expect_refusal([&] { Particles(points, {}, 1); }, {"face"});
  for (const double bad : {kNan, kInfinity, -1.0, 0.0}) {
    expect_refusal([&] { Particles(points, faces, bad); }, {"mass"});
  }
  expect_refusal([&] { Particles({{0, 0, 0}, {1, kNan, 0}, {0, 1, 0}}, faces, 1); }, {"position of point 1"});
  expect_refusal([&] { Particles(points, {{0, 1, 3}}, 1); }, {"vertex"});
  expect_refusal([&] { Particles(points, {{0, -1, 2}}, 1); }, {"vertex"});
}

TEST(Guard, PutsABodyBackOnceAndItGoesOn) {
  for (const bool in_contact : {false, true}) {
    TestWorld world;
    world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
    DeformableSystem system(*world);
    Particles body = Particles::tetrahedron(Vec3(0, in_contact ? 0.151 : 3.0, 0));
    system.add(body);
    btRigidBody& box = world.add_box(Vec3(0.2, 0.05, 0.2), 1, Vec3(0, in_contact ? 0.36 : 3.5, 0));
    const HandleId handle = system.grab(body, 0, body.points()[0], in_contact ? 50.0 : 5.0);
    world.step(30);
    body.poison = 2;
    world.step();
    EXPECT_EQ(body.guard_fired(), 1);
    EXPECT_EQ(system.profile().totals.guard_fired, 1);
    EXPECT_EQ(body.restored_calls, 1);
    for (int i = 0; i < 60; ++i) {
      world.step();
      for (int v = 0; v < 4; ++v) {
        ASSERT_TRUE(body.points()[static_cast<std::size_t>(v)].allFinite());
        ASSERT_TRUE(std::isfinite(double(body.m_nodes[v].m_x.y())));
      }
      ASSERT_TRUE(std::isfinite(double(box.getWorldTransform().getOrigin().y())));
      ASSERT_TRUE(std::isfinite(double(box.getLinearVelocity().y())));
      ASSERT_TRUE(system.handle_force(handle).allFinite());
      for (const ContactPoint& p : system.contacts()) ASSERT_TRUE(p.force.allFinite());
    }
    EXPECT_EQ(body.guard_fired(), 1) << "the poison lives on; in contact: " << in_contact;
  }
}

TEST(Impulse, ActsInTheNextStepAtItsPoint) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Particles body = Particles::tetrahedron(Vec3::Zero());
  system.add(body);
  body.apply_impulse(0, Vec3(0.2, 0.3, 0.5), Vec3(1, 2, 3));
  EXPECT_EQ(body.momentum(), Vec3(Vec3::Zero()));
  world.step();
  EXPECT_LT((body.momentum() - Vec3(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((body.velocities()[1] - 0.3 * Vec3(1, 2, 3)).norm(), 1e-12);
  world.step();
  EXPECT_LT((body.momentum() - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST(Profile, CountsWorkDoneAndSkipped) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  Particles low = Particles::tetrahedron(Vec3(0, 0.151, 0)), high = Particles::tetrahedron(Vec3(0, 50, 0));
  system.add(low);
  system.add(high);
  world.step(3);
  const Profile& profile = system.profile();
  EXPECT_EQ(profile.counts.deformables, 2);
  EXPECT_EQ(profile.counts.without_pairs + profile.counts.pairs, 2);
  EXPECT_EQ(profile.counts.without_contacts, 1);
  EXPECT_EQ(profile.counts.contacts, 3);
  EXPECT_GT(profile.counts.passes, 0);
  EXPECT_GT(profile.seconds.total(), 0.0);
  EXPECT_EQ(profile.totals.substeps, 3);
  EXPECT_EQ(profile.totals.late_substeps, 0);
}

TEST(Handles, IdsAreNeverReusedAndDieWithTheirBody) {
  TestWorld world;
  DeformableSystem system(*world);
  auto body = std::make_unique<Particles>(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                          std::vector<Triangle>{{0, 1, 2}}, 1.0);
  Particles other = Particles::tetrahedron(Vec3(3, 0, 0));
  system.add(*body);
  system.add(other);
  const HandleId first = system.grab(*body, 0, Vec3::Zero()), second = system.grab(other, 1, Vec3(3, 1, 0));
  body.reset();
  expect_refusal([&] { system.move(first, Vec3::Zero()); }, {"handle"});
  world.step(5);
  EXPECT_LT((other.points()[1] - Vec3(3, 1, 0)).norm(), 1e-6);  // its index has moved up
  system.release(second);
  EXPECT_GT(system.grab(other, 0, Vec3::Zero()), second);
}

}  // namespace
}  // namespace softpoint
