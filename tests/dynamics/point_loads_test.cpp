// Loads on vertices of an elastic body are part of the implicit step: they balance exactly at rest, keep the
// momentum they have no right to change, never blow up, and contacts and handles feel them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <random>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/spring_net.h"
#include "support/state_hash.h"
#include "support/tier.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

Eigen::MatrixXd random_stiffness(std::mt19937& random, std::size_t points, double scale) {
  std::normal_distribution<double> normal;
  const auto n = static_cast<Eigen::Index>(3 * points);
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(
      n, 1 + static_cast<Eigen::Index>(random() % static_cast<unsigned>(n)), [&] { return normal(random); });
  const Eigen::MatrixXd k = a * a.transpose();
  return scale / k.diagonal().maxCoeff() * k;
}

Eigen::MatrixXd even_stiffness(std::size_t points, double k) {
  const auto n = static_cast<Eigen::Index>(3 * points);
  return k * Eigen::MatrixXd::Identity(n, n);
}

// Forces without sum and moment about the points as they are.
std::vector<Vec3> balanced(const ElasticBody& body, const std::vector<int>& points, double size) {
  SpringNet net(body, points, even_stiffness(points.size(), 1.0));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (Vec3& r : net.rest) r += 0.1 * Vec3(normal(random), normal(random), normal(random));
  net.update(body);
  double largest = 0;
  for (const Vec3& f : net.forces) largest = std::max(largest, f.norm());
  for (Vec3& f : net.forces) f *= size / largest;
  return net.forces;
}

TestWorld& without_gravity(TestWorld& world) {
  world->setGravity(btVector3(0, 0, 0));
  return world;
}

TEST(PointLoads, ClearedOrNeverSetGiveTheSameBits) {
  std::uint64_t bits[2];
  for (const bool cleared : {false, true}) {
    TestWorld world;
    world.add_floor();
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube), Vec3(0, 0.3, 0));
    body.set_velocity(Vec3(1, 0, 0), Vec3(1, 2, 3));
    system.add(body);
    if (cleared) {
      body.set_point_loads(std::vector<int>{0, 3}, std::vector<Vec3>{Vec3(1, 0, 0), Vec3(2, 0, 0)});
      body.clear_point_loads();
    }
    bits[cleared] = play(world, system, 120).back();
  }
  EXPECT_EQ(bits[0], bits[1]);
}

// Springs between points of a body that flies, turns and rings.
TEST(PointLoads, BetweenPointsOfABodyKeepMomentumAndSpinAndGiveNoEnergy) {
  std::mt19937 random(1);
  for (const std::vector<int>& points :
       {std::vector<int>{0, 5, 11, 20, 25}, std::vector<int>{2, 9}, std::vector<int>{1, 8, 17}}) {
    for (const double young : {1e4, 1e6}) {
      for (const double k : {1e2, 1e5, 1e9}) {
        for (const double dt : {1.0 / 60, 1.0 / 1000}) {
          TestWorld world;
          DeformableSystem system(*without_gravity(world));
          ElasticBody body(model_of(Shape::cube, young, dt), Vec3(0.2, 0.1, 0));
          SpringNet net(body, points, random_stiffness(random, points.size(), k));
          body.set_velocity(Vec3(0.4, -0.3, 0.2), Vec3(1, 3, 2));
          body.apply_impulse(0, Vec3(1, 0, 0), Vec3(0.2, 0.3, -0.1) * body.total_mass() * 0.2);
          system.add(body);
          world.step(1, dt);
          const Vec3 momentum = body.momentum(), spin = body.angular_momentum(body.center_of_mass());
          net.update(body);
          const double first = energy_of(body) + net.energy;
          double worst_momentum = 0, worst_spin = 0, worst_gain = 0, last = first;
          for (int i = 0; i < 200; ++i) {
            net.load(body);
            world.step(1, dt);
            worst_momentum = std::max(worst_momentum, (body.momentum() - momentum).norm() / momentum.norm());
            worst_spin = std::max(worst_spin,
                                  (body.angular_momentum(body.center_of_mass()) - spin).norm() / spin.norm());
            net.update(body);
            const double now = energy_of(body) + net.energy;
            worst_gain = std::max(worst_gain, (now - last) / first);
            last = now;
          }
          std::printf(
              "    %zu points, E %.0e, K %.0e, dt %.4f: momentum %.1e, spin %.1e, gain %.1e, left %.4f\n",
              points.size(), young, k, dt, worst_momentum, worst_spin, worst_gain, last / first);
          EXPECT_LE(worst_momentum, 1e-11);
          EXPECT_LE(worst_spin, 1e-11);
          // Springs so stiff that they deform the body at once turn their own frame within the step.
          EXPECT_LE(worst_gain, k < 1e6 ? by_precision(1e-12, 1e-10) : 1e-4);
          EXPECT_EQ(system.profile().totals.guard_fired, 0);
        }
      }
    }
  }
}

// Constant forces that balance: the body comes to rest, the loads are then what they were set to.
TEST(PointLoads, AtRestTheForceIsTheOneSetAndBalances) {
  for (const double young : {1e4, 1e6}) {
    for (const double k : {0.0, 1e-3 * young, 0.1 * young}) {
      TestWorld world;
      DeformableSystem system(*without_gravity(world));
      ElasticBody body(model_of(Shape::cube, young), Vec3(0.2, 0.1, 0));
      body.setActivationState(DISABLE_DEACTIVATION);
      const std::vector<int> points{0, 7, 12, 19, 25};
      system.add(body);
      const Eigen::MatrixXd stiffness = even_stiffness(points.size(), k);
      std::vector<Vec3> forces;
      for (int i = 0; i < 3000; ++i) {
        // They stay balanced while the body gives way.
        forces = balanced(body, points, 1e-3 * young * 0.16);
        body.set_point_loads(points, forces, {stiffness.data(), std::size_t(stiffness.size())});
        world.step();
      }
      const std::vector<Vec3> before(body.points().begin(), body.points().end());
      double worst = 0, moved = 0, size = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        size = std::max(size, forces[i].norm());
        worst = std::max(worst, (body.point_load_forces()[i] - forces[i]).norm());
      }
      std::vector<double> d;
      body.displacements(d);
      const Eigen::Index n = body.model().dofs();
      const Eigen::Map<const Eigen::MatrixXd> s(body.model().stiffness->unit_stiffness.data(), n, n);
      Eigen::VectorXd left = young * (s * Eigen::Map<const Eigen::VectorXd>(d.data(), n));
      for (std::size_t i = 0; i < points.size(); ++i) {
        left.segment<3>(3 * points[i]) -= body.frame().transpose() * forces[i];
      }
      // What the loads' moment about the rest shape makes is no force on the strained one.
      Eigen::MatrixXd modes(n, 6);
      for (Eigen::Index v = 0; v < n / 3; ++v) {
        for (int a = 0; a < 3; ++a) {
          modes.col(a).segment<3>(3 * v) = Vec3::Unit(a);
          modes.col(3 + a).segment<3>(3 * v) = Vec3::Unit(a).cross(body.model().rest[std::size_t(v)]);
        }
      }
      for (Eigen::Index v = 0; v < n / 3; ++v) modes.middleRows<3>(3 * v) *= body.masses()[std::size_t(v)];
      const Eigen::VectorXd fit = modes.colPivHouseholderQr().solve(left);
      left -= modes * fit;
      world.step(60);
      for (std::size_t v = 0; v < before.size(); ++v) {
        moved = std::max(moved, (body.points()[v] - before[v]).norm());
      }
      std::printf("    E %.0e K %.0e: load off by %.1e, balance off by %.1e (of it), moves %.1e m in 1 s\n",
                  young, k, worst / size, left.norm() / size, moved);
      EXPECT_LE(worst / size, 1e-12);
      EXPECT_LE(left.norm() / size, kDouble ? 1e-9 : 1e-6);  // a world in single precision rounds the gravity
      EXPECT_LE(moved, 1e-9);
    }
  }
}

TEST(PointLoads, WithoutCounterpartPushAndTurnTheBody) {
  for (const double dt : {1.0 / 60, 1.0 / 1000}) {
    TestWorld world;
    DeformableSystem system(*without_gravity(world));
    ElasticBody body(model_of(Shape::cube, 1e6, dt));
    system.add(body);
    const std::vector<int> points{4, 21};
    const double step = btScalar(dt);
    Vec3 push = Vec3::Zero(), twist = Vec3::Zero();
    double work = 0;
    for (int i = 0; i < 100; ++i) {
      const std::vector<Vec3> forces{Vec3(1, 2, 3), Vec3(-2, 1, 0)};
      body.set_point_loads(points, forces);
      const Vec3 center = body.center_of_mass();
      std::vector<Vec3> from;
      for (const int p : points) from.push_back(body.points()[std::size_t(p)]);
      world.step(1, dt);
      for (std::size_t k = 0; k < 2; ++k) {
        push += step * body.point_load_forces()[k];
        // Where the rigid turn has carried the points, along with the force.
        twist += step * (from[k] - center).cross(forces[k]);
        work += body.point_load_forces()[k].dot(body.points()[std::size_t(points[k])] - from[k]);
      }
    }
    EXPECT_LE((body.momentum() - push).norm(), 1e-12 * push.norm());
    const Vec3 spin = body.angular_momentum(body.center_of_mass());
    EXPECT_NEAR(spin.norm() / twist.norm(), 1.0, dt < 0.01 ? 0.01 : 0.2);
    std::printf("    dt %.4f: energy %.6g J, work %.6g J\n", dt, energy_of(body), work);
    EXPECT_LE(energy_of(body), work * (1 + 1e-9));
    EXPECT_GE(energy_of(body), work * (dt < 0.01 ? 0.95 : 0.8));
  }
}

// A pull that stretches the body by its own work; the guard against false gains must let it.
TEST(PointLoads, WorkStaysInTheBody) {
  for (const double dt : {1.0 / 60, 1.0 / 1000}) {
    TestWorld world;
    DeformableSystem system(*without_gravity(world));
    ElasticBody body(model_of(Shape::bar, 1e5, dt));
    system.add(body);
    std::vector<int> points;
    std::vector<Vec3> forces;
    for (std::size_t v = 0; v < body.points().size(); ++v) {
      const double x = body.model().rest[v].x();
      if (std::abs(x) > 0.49) {
        points.push_back(int(v));
        forces.push_back(Vec3(x > 0 ? 1 : -1, 0, 0) * 40.0 / 9);
      }
    }
    double work = 0, most = 0;
    for (int i = 0; i < int(std::lround(0.1 / dt)); ++i) {
      std::vector<Vec3> from(body.points().begin(), body.points().end());
      body.set_point_loads(points, forces);
      world.step(1, dt);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const auto p = std::size_t(points[k]);
        work += body.point_load_forces()[k].dot(body.points()[p] - from[p]);
      }
      EXPECT_LE(energy_of(body), work * (1 + 1e-10) + 1e-14);
      most = std::max(most, energy_of(body) / work);
    }
    std::printf("    dt %.4f: of %.5g J of work %.4f are in the body\n", dt, work, energy_of(body) / work);
    EXPECT_GE(energy_of(body) / work, dt < 0.01 ? 0.95 : 0.5);
  }
}

// Any stiffness, any share of the true one up to half too little, any step.
TEST(PointLoads, NeverDiverge) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  const auto between = [&](double low, double high) {  // evenly in the logarithm
    return low * std::pow(high / low, uniform(random));
  };
  const int cases = full_tier() ? 2000 : 120;
  double worst = 0;
  for (int c = 0; c < cases; ++c) {
    const double dt = std::array{1.0 / 15, 1.0 / 60, 1.0 / 240, 1.0 / 1000}[random() % 4];
    const double young = std::array{1e3, 1e5, 1e7, 1e10}[random() % 4];
    const double k = random() % 8 == 0 ? 0.0 : between(1e-2, 1e12);
    const bool at_the_limit = random() % 4 == 0;
    const double below = uniform(random);
    const double dent = between(1e-6, 0.02), spin = random() % 2 ? 0.0 : between(0.1, 5.0);
    // True stiffness over the told one. Twice is the limit itself, where what spins has nothing left to stand
    // on.
    const double share = (spin > 0 ? 1.9 : 2.0) * (at_the_limit ? 1.0 : below);
    TestWorld world;
    DeformableSystem system(*without_gravity(world));
    ElasticBody body(model_of(Shape::cube, young, dt), Vec3(0.2, 0.1, 0));
    std::vector<int> points;
    for (int p = 0; p < 26; ++p) {
      if (uniform(random) < 0.25) points.push_back(p);
    }
    if (points.empty()) points.push_back(0);
    SpringNet net(body, points, random_stiffness(random, points.size(), k * share));
    for (Vec3& r : net.rest) r += dent * Vec3(uniform(random) - 0.5, uniform(random) - 0.5, uniform(random));
    body.set_velocity(Vec3(0.1, 0, 0), spin * Vec3(1, 0.3, -0.5));
    system.add(body);
    double largest = 0;
    const int steps = full_tier() ? 1000 : 150;
    for (int i = 0; i < steps; ++i) {
      net.load(body, share > 0 ? 1.0 / share : 1.0);
      world.step(1, dt);
      for (std::size_t v = 0; v < body.points().size(); ++v) {
        largest = std::max(largest, std::abs((body.points()[v] - body.center_of_mass()).norm() -
                                             body.model().rest[v].norm()));
      }
    }
    if (spin == 0) worst = std::max(worst, largest / dent);
    // A soft body that spins fast is stretched by that alone.
    EXPECT_LE(largest, 20 * dent + (spin > 0 && young < 1e5 ? 0.4 : 0.01 * spin))
        << "case " << c << ": dt " << dt << ", E " << young << ", K " << k << ", true/told " << share
        << ", spin " << spin << ", " << points.size() << " points, dent " << dent;
    EXPECT_EQ(system.profile().totals.guard_fired, 0) << "case " << c;
  }
  std::printf("    %d cases, largest change of a radius %.2f of the springs' misfit (without spin)\n", cases,
              worst);
}

// A stiff spring along one line leaves rounding across it, whichever way the world's axes lie.
TEST(PointLoads, StiffnessOfOneTurnedSpringIsTaken) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  ElasticBody body(model_of(Shape::cube, 1e5));
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3 axis = Vec3(normal(random), normal(random), normal(random)).normalized();
    const Mat3 turn(Eigen::AngleAxisd(1e-5 * normal(random), axis).toRotationMatrix());
    Mat3 turned = turn * Vec3(1e9, 0, 0).asDiagonal() * turn.transpose();
    turned = (0.5 * (turned + turned.transpose())).eval();
    const std::array<int, 1> points{0};
    const std::array<Vec3, 1> forces{Vec3::Zero()};
    EXPECT_NO_THROW(body.set_point_loads(points, forces, {turned.data(), 9})) << turned;
  }
}

// A handle that cannot give way arrives exactly, which it does only if the solver's compliance and the answer
// to its impulses both hold the springs.
TEST(PointLoads, HandlesFeelTheSprings) {
  for (const double k : {0.0, 1e3, 1e6, 1e10}) {
    TestWorld world;
    DeformableSystem system(*without_gravity(world));
    ElasticBody body(model_of(Shape::cube, 1e5));
    body.setActivationState(DISABLE_DEACTIVATION);
    system.add(body);
    const std::vector<int> points{0, 7, 12, 19, 25};
    SpringNet net(body, points, even_stiffness(points.size(), k));
    const HandleId a = system.grab(body, 25, body.points()[25]), b = system.grab(body, 3, body.points()[3]);
    const Vec3 from = body.points()[25];
    double worst = 0, unbalanced = 0;
    for (int i = 0; i < 240; ++i) {
      const Vec3 target = from + std::min(i / 60.0, 1.0) * Vec3(0.02, 0.01, -0.01);
      system.move(a, target);
      net.load(body);
      const Vec3 before = body.momentum();
      world.step();
      worst = std::max(worst, (body.points()[25] - target).norm());
      const Vec3 force = system.handle_force(a) + system.handle_force(b);
      unbalanced = std::max(unbalanced, ((body.momentum() - before) * 60.0 - force).norm());
    }
    std::printf("    K %.0e: handle off by %.1e m, force %.4g N, momentum off by %.1e N\n", k, worst,
                system.handle_force(a).norm(), unbalanced);
    EXPECT_LE(worst, 1e-7);
    EXPECT_LE(unbalanced, by_precision(1e-7, 1e-4) * (1 + system.handle_force(a).norm()));
  }
}

TEST(PointLoads, AChangeWakesASleepingBodyAndTheSameDoesNot) {
  TestWorld world;
  DeformableSystem system(*without_gravity(world));
  ElasticBody body(model_of(Shape::cube, 1e6));
  system.add(body);
  const std::vector<int> points{0, 25};
  const Vec3 along = (body.points()[25] - body.points()[0]).normalized();
  const auto set = [&](double force) {
    body.set_point_loads(points, std::vector<Vec3>{-force * along, force * along});
  };
  for (int i = 0; i < 600; ++i) {
    set(5);
    world.step();
  }
  ASSERT_TRUE(body.asleep());
  set(5 * (1 + 1e-13));
  world.step(3);
  EXPECT_TRUE(body.asleep());
  set(6);
  world.step();
  EXPECT_FALSE(body.asleep());
  for (int i = 0; i < 600; ++i) world.step();
  ASSERT_TRUE(body.asleep());
  body.clear_point_loads();
  world.step();
  EXPECT_FALSE(body.asleep());
}

TEST(PointLoads, WhatIsOutOfRangeIsRefusedAndChangesNothing) {
  ElasticBody body(model_of(Shape::cube));
  TestWorld world;
  DeformableSystem system(*without_gravity(world));
  system.add(body);
  const std::vector<int> points{0, 25};
  const std::vector<Vec3> forces{Vec3(1, 0, 0), Vec3(-1, 0, 0)};
  body.set_point_loads(points, forces);
  const double bad = std::nan("");
  std::vector<double> k(36, 0.0);
  const auto refused = [&](std::span<const int> p, std::span<const Vec3> f, std::span<const double> s,
                           const char* what) {
    expect_refusal([&] { body.set_point_loads(p, f, s); }, {what, "permitted is"});
  };
  refused(std::vector<int>{0, 26}, forces, {}, "point");
  refused(std::vector<int>{-1, 2}, forces, {}, "point");
  refused(std::vector<int>{0}, forces, {}, "forces has 2");
  refused(points, std::vector<Vec3>{Vec3(bad, 0, 0), Vec3::Zero()}, {}, "force");
  refused(points, std::vector<Vec3>{Vec3(0, 2e18, 0), Vec3::Zero()}, {}, "force");
  refused(points, forces, std::vector<double>(35, 0.0), "stiffness has 35");
  k[7] = bad;
  refused(points, forces, k, "stiffness");
  k[7] = 2e15;
  refused(points, forces, k, "stiffness");
  k[7] = -1;
  refused(points, forces, k, "semidefinite");
  k[7] = 1;
  k[1] = 1;
  refused(points, forces, k, "asymmetry");
  k[6] = 1, k[7] = 0;
  refused(points, forces, k, "semidefinite");
  world.step();
  ASSERT_EQ(body.point_load_forces().size(), 2u);
  EXPECT_LE((body.point_load_forces()[0] - forces[0]).norm(), 1e-12);
}

}  // namespace
}  // namespace softpoint
