// A free elastic body keeps its angular momentum, never gains energy and falls without changing shape.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

struct Spin {
  Shape shape;
  double young;
  double dt;
  Vec3 rate;  // rad/s
  double seconds;
  bool vibrating = false;
};

void PrintTo(const Spin& s, std::ostream* out) {
  *out << "shape " << static_cast<int>(s.shape) << ", E " << s.young << " Pa, dt " << s.dt << " s, omega "
       << s.rate.transpose() << " rad/s" << (s.vibrating ? ", vibrating" : "");
}

class SpinningBody : public ::testing::TestWithParam<Spin> {};

TEST_P(SpinningBody, KeepsSpinAndNeverGainsEnergy) {
  const Spin& c = GetParam();
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(c.shape, c.young, c.dt), Vec3(0.4, -0.2, 0.1));
  body.set_velocity(Vec3(0.5, -0.3, 0.2), c.rate);
  if (c.vibrating) {
    body.apply_impulse(0, Vec3(1, 0, 0), Vec3(0.2, 0.3, -0.1) * body.total_mass());
  }
  system.add(body);
  if (c.vibrating) {
    world.step(1, c.dt);
  }
  const auto spin_of = [&] { return body.angular_momentum(body.center_of_mass()); };
  const Vec3 spin = spin_of(), momentum = body.momentum();
  const double first = energy_of(body);
  double last = first, worst_spin = 0, worst_gain = 0, worst_drift = 0;
  const int steps = static_cast<int>(std::lround(c.seconds / c.dt));
  for (int i = 0; i < steps; ++i) {
    world.step(1, c.dt);
    worst_spin = std::max(worst_spin, (spin_of() - spin).norm() / spin.norm());
    worst_drift = std::max(worst_drift, (body.momentum() - momentum).norm() / momentum.norm());
    const double now = energy_of(body);
    worst_gain = std::max(worst_gain, (now - last) / first);
    last = now;
  }
  std::printf(
      "    E %.0e dt 1/%-4.0f |omega| %-4.1f: |dL|/L %.1e, |dp|/p %.1e, largest gain %.1e, energy left "
      "%.6f\n",
      c.young, 1.0 / c.dt, c.rate.norm(), worst_spin, worst_drift, worst_gain, last / first);
  EXPECT_LE(worst_spin, 1e-12);
  EXPECT_LE(worst_drift, 1e-11);
  // The step of a float world differs from the body's own in the last digits.
  EXPECT_LE(worst_gain, by_precision(1e-13, 1e-11));
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

std::vector<Spin> spins() {
  std::vector<Spin> cases;
  const Vec3 principal(0, 0, 5), tumbling(1, 5, 2);
  for (const double young : {1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11}) {
    for (const Vec3& rate : {principal, tumbling}) {
      cases.push_back({Shape::part, young, 1.0 / 60, rate, 10});
    }
  }
  for (const double dt : {1.0 / 30, 1.0 / 120, 1.0 / 240, 1.0 / 1000}) {
    for (const double young : {1e4, 1e6, 1e11}) {
      cases.push_back({Shape::cube, young, dt, tumbling, dt < 0.002 ? 3.0 : 10.0});
      cases.push_back({Shape::bar, young, dt, tumbling, dt < 0.002 ? 0.3 : 2.0});
    }
  }
  cases.push_back({Shape::bar, 1e6, 1.0 / 60, Vec3(0, 20, 0.01), 10});  // about the unstable middle axis
  cases.push_back({Shape::bar, 1e4, 1.0 / 60, Vec3(0, 8, 0), 10});      // far beyond small strain
  cases.push_back({Shape::ball, 1e5, 1.0 / 60, Vec3(0, 30, 3), 10});
  for (const double young : {1e4, 1e6, 1e9}) {
    cases.push_back({Shape::part, young, 1.0 / 60, tumbling, 10, true});
    cases.push_back({Shape::cube, young, 1.0 / 240, tumbling, 5, true});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Cases, SpinningBody, ::testing::ValuesIn(spins()));

TEST(FreeFall, KeepsTheShape) {
  for (const double young : {1e4, 1e6, 1e9}) {
    TestWorld world;
    DeformableSystem system(*world);
    const Mat3 turned = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    ElasticBody body(model_of(Shape::part, young), Vec3(0, 100, 0), turned);
    system.add(body);
    world.step(180);
    std::vector<double> d;
    body.displacements(d);
    double largest = 0;
    for (const double x : d) largest = std::max(largest, std::abs(x));
    EXPECT_LT(largest, 1e-12) << "E = " << young;
    EXPECT_LT((body.frame() - turned).norm(), 1e-12);
  }
}

TEST(FreeFall, AccelerationOfOneBodyAddsToGravity) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3::Zero());
  body.set_acceleration(Vec3(1, 9.81, -2));
  world->setGravity(btVector3(0, btScalar(-9.81), 0));
  system.add(body);
  world.step(60);
  EXPECT_LT((body.momentum() / body.total_mass() - Vec3(1, 0, -2)).norm(), by_precision(1e-12, 1e-6));
}

TEST(FreeMotion, RigidVelocityStaysRigid) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball, 1e9), Vec3::Zero());
  body.set_velocity(Vec3(1, 2, 3), Vec3(0, 0, 2));
  system.add(body);
  world.step(60);
  EXPECT_LT((body.center_of_mass() - Vec3(1, 2, 3)).norm(), 1e-6);
  // Turned by 2 rad about z; the rate falls a little as the shape bulges.
  const Mat3 expected = Eigen::AngleAxisd(2.0, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_LT((body.frame() - expected).norm(), 1e-3);
}

// dt as Bullet hands it over may differ in the last float digits: that is no new step.
TEST(FreeMotion, TimeStepChangesAreCountedAndHarmless) {
  TestWorld world;
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube), Vec3(0, 10, 0));
  system.add(body);
  world.step(5);
  EXPECT_EQ(system.profile().totals.refactorizations, 0);
  world.step(5, 1.0 / 120);
  EXPECT_EQ(system.profile().totals.refactorizations, 1);
  world.step(5);
  world.step(5, 1.0 / 120);
  EXPECT_LE(system.profile().totals.refactorizations, 2);
  EXPECT_LT(body.elastic_energy(), 1e-12 * body.kinetic_energy());
}

}  // namespace
}  // namespace softpoint
