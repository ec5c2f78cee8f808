// Laws of whole figures: power, chained hinges against balls, gimbal lock, masses of every size, long rough
// handling.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <memory>
#include <numbers>

#include "group_motion.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

bool all_finite(const std::vector<double>& numbers) {
  for (const double x : numbers) {
    if (!std::isfinite(x)) return false;
  }
  return true;
}

TEST(FigureLaws, EnergyChangesByThePowerOfTorquesFrictionAndLoads) {
  RandomFigures random(51);
  double worst = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const FigureModel model = random.model(1 + trial % 12, trial % 2 == 0);
    FigureDynamics dynamics(model);
    const FigureState state = random.state(model);
    const std::vector<double> tau = random.numbers(model.velocity_count());
    const std::vector<Wrench> loads = {{random.below(model.link_count()), random.vector(), random.vector()}};
    std::vector<double> qdd(state.qd.size());
    dynamics.forward(state.q.data(), state.qd.data(), tau.data(), qdd.data(), loads);
    double power = 0, size = 1;
    for (int i = 0; i < model.link_count(); ++i) {
      const Link& link = model.links()[static_cast<std::size_t>(i)];
      const double rubbing = link.joint == JointKind::kFree ? 0 : link.damping;
      for (int k = 0; k < velocity_count(link.joint); ++k) {
        const auto v = static_cast<std::size_t>(model.velocity_offset(i) + k);
        power += (tau[v] - rubbing * state.qd[v]) * state.qd[v];
        size += std::abs(tau[v] * state.qd[v]) + rubbing * state.qd[v] * state.qd[v];
      }
    }
    dynamics.place(state.q.data(), state.qd.data());
    const LinkMotion motion = dynamics.motion(loads[0].link);
    power += loads[0].moment.dot(motion.angular_velocity) + loads[0].force.dot(motion.velocity);
    const double t = 1e-5;
    const auto energy_at = [&](double when) {
      std::vector<double> d(state.qd.size()), q = state.q, qd = state.qd;
      for (std::size_t k = 0; k < d.size(); ++k) {
        d[k] = when * state.qd[k];
        qd[k] += when * qdd[k];
      }
      move_by(model, state.q.data(), d.data(), q.data());
      dynamics.place(q.data(), qd.data());
      const FigureMechanics sums = dynamics.mechanics();
      size = std::max(size, sums.kinetic_energy);
      return sums.kinetic_energy + sums.potential_energy;
    };
    const double change = (energy_at(t) - energy_at(-t)) / (2 * t);
    worst = std::max(worst, std::abs(change - power) / size);
  }
  std::printf("    power off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-6);  // of the difference quotient
}

// Arms of the paper's cylinders, each joint a ball or its three hinges with massless links between.
FigureModel arms(bool hinges) {
  std::vector<Link> links;
  const auto add = [&](int parent, const Vec3& origin, const char* name) {
    Link link;
    link.name = name;
    link.parent = parent;
    link.origin = origin;
    if (!hinges) {
      link.joint = JointKind::kBall;
    } else {
      for (int k = 2; k >= 1; --k) {  // z, y, then x with the mass
        Link inner;
        inner.name = std::string(name) + (k == 2 ? "_z" : "_y");
        inner.parent = link.parent;
        inner.axis = Vec3::Unit(k);
        inner.origin = link.origin;
        links.push_back(inner);
        link.parent = static_cast<int>(links.size()) - 1;
        link.origin = Vec3::Zero();
      }
      link.axis = Vec3::UnitX();
    }
    set_cylinder(link, 2.0, 0.05, 0.4);
    links.push_back(link);
    return static_cast<int>(links.size()) - 1;
  };
  const int upper = add(-1, {0, 0, 1}, "upper");
  const int lower = add(upper, {0, 0, 0.4}, "lower");
  add(lower, {0, 0, 0.4}, "hand");
  add(upper, {0, 0, 0.4}, "other");
  return FigureModel(links);
}

// The same pose and spins for both.
void set_arms(const FigureModel& balls, const FigureModel& hinges, RandomFigures& random,
              FigureState& ball_state, FigureState& hinge_state) {
  ball_state = rest_state(balls);
  hinge_state = rest_state(hinges);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 angle = 0.4 * random.vector().array().tanh(), rate = random.vector();
    Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
    Vec3 spin = Vec3::Zero();  // in the child's axes
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 axis = Vec3::Unit(2 - static_cast<int>(k));
      const Eigen::Quaterniond by(Eigen::AngleAxisd(angle[static_cast<int>(k)], axis));
      turn = turn * by;
      spin = by.conjugate() * spin + axis * rate[static_cast<int>(k)];
      hinge_state.q[3 * i + k] = angle[static_cast<int>(k)];
      hinge_state.qd[3 * i + k] = rate[static_cast<int>(k)];
    }
    const double q[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    std::copy_n(q, 4, &ball_state.q[4 * i]);
    std::copy_n(spin.data(), 3, &ball_state.qd[3 * i]);
  }
}

TEST(FigureLaws, ChainedHingesMoveAsBallsDoAwayFromGimbalLock) {
  const FigureModel balls = arms(false), hinges = arms(true);
  EXPECT_EQ(balls.velocity_count(), hinges.velocity_count());
  RandomFigures random(61);
  double worst = 0;
  int compared = 0;
  for (int trial = 0; trial < 10; ++trial) {
    FigureState ball_state, hinge_state;
    set_arms(balls, hinges, random, ball_state, hinge_state);
    FigureStepper a(balls, ball_state, Integrator::kDormandPrince);
    FigureStepper b(hinges, hinge_state, Integrator::kDormandPrince);
    for (int i = 0; i < 600; ++i) {
      a.step(1.0 / 2000);
      b.step(1.0 / 2000);
      double straightest = 1;
      for (std::size_t k = 0; k < 4; ++k) {
        straightest = std::min(straightest, std::abs(std::cos(b.state().q[3 * k + 1])));
      }
      if (straightest < 0.4) break;
      a.dynamics().place(a.state().q.data(), a.state().qd.data());
      b.dynamics().place(b.state().q.data(), b.state().qd.data());
      for (int k = 0; k < 4; ++k) {
        const LinkMotion x = a.dynamics().motion(k), y = b.dynamics().motion(3 * k + 2);
        worst = std::max({worst, (x.position - y.position).norm(), (x.orientation - y.orientation).norm()});
      }
      ++compared;
    }
  }
  std::printf("    %d poses, apart by %.1e\n", compared, worst);
  EXPECT_GT(compared, 1000);
  EXPECT_LE(worst, 1e-9);
}

TEST(FigureLaws, GimbalLockStaysFinite) {
  const FigureModel bare = arms(true), balls = arms(false);
  std::vector<Link> links = bare.links();
  for (Link& link : links) link.armature = 1e-3;
  const FigureModel eased(links);
  RandomFigures random(71);
  double fastest = 0;
  for (const FigureModel* model : {&bare, &eased}) {
    FigureDynamics dynamics(*model);
    for (double away : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1}) {
      for (const double side : {-1.0, 1.0}) {
        FigureState state = rest_state(*model);
        for (double& q : state.q) q = 0.3 * random.vector().x();
        for (double& v : state.qd) v = random.vector().x();
        for (std::size_t i = 0; i < 4; ++i) state.q[3 * i + 1] = side * (std::numbers::pi / 2 - away);
        std::vector<double> qdd(state.qd.size());
        dynamics.forward(state.q.data(), state.qd.data(), nullptr, qdd.data());
        EXPECT_TRUE(all_finite(qdd)) << away;
        if (model == &bare) continue;
        for (const double a : qdd) fastest = std::max(fastest, std::abs(a));
        // And through it: the step is right or says that it is not, and the state stays finite.
        FigureStepper stepper(*model, state);
        for (int i = 0; i < 120; ++i) stepper.step(1.0 / 240);
        EXPECT_TRUE(all_finite(stepper.state().q));
        EXPECT_EQ(stepper.guard_fired(), 0);
      }
    }
  }
  // Balls have no such place at all.
  double turning = 0;
  for (int i = 0; i <= 100; ++i) {
    FigureState state = rest_state(balls);
    const double angle = 0.45 * std::numbers::pi + 0.1 * std::numbers::pi * i / 100;
    for (std::size_t k = 0; k < 4; ++k) {
      state.q[4 * k] = std::cos(angle / 2);
      state.q[4 * k + 2] = std::sin(angle / 2);
    }
    for (double& v : state.qd) v = 1;
    FigureDynamics dynamics(balls);
    std::vector<double> qdd(state.qd.size());
    dynamics.forward(state.q.data(), state.qd.data(), nullptr, qdd.data());
    for (const double a : qdd) turning = std::max(turning, std::abs(a));
  }
  std::printf("    hinges with an armature of 1e-3 up to %.1e rad/s2, balls to %.1e\n", fastest, turning);
  EXPECT_LE(turning, 1e4);
}

// A limp arm whose hand and fingers weigh next to nothing: energy of the arm makes them turn by hundreds of
// radians a second, which explicit stages of a thirtieth of a second could not follow.
TEST(FigureLaws, LightHandsOfLimpArmsStayFinite) {
  std::vector<Link> links;
  const double lengths[] = {0.3, 0.2, 0.04, 0.03, 0.02};
  for (int i = 0; i < 5; ++i) {
    Link link;
    link.name = "link" + std::to_string(i);
    link.parent = i - 1;
    link.joint = JointKind::kBall;
    if (i > 0) link.origin = Vec3(0, 0, lengths[i - 1]);
    const double radius = 0.1 * lengths[i];
    set_cylinder(link, 1000 * std::numbers::pi * radius * radius * lengths[i], radius, lengths[i]);
    links.push_back(link);
  }
  const FigureModel model(links);
  RandomFigures random(19);
  for (const Integrator how : {Integrator::kRungeKutta4, Integrator::kDormandPrince}) {
    for (const double dt : {1.0 / 15, 1.0 / 30, 1.0 / 240}) {
      long long parts = 0;
      double worst = 0, fastest = 0;
      for (int trial = 0; trial < 5; ++trial) {
        FigureStepper stepper(model, random.state(model), how);
        const double energy = stepper.energy();
        double highest = energy;
        for (double t = 0; t < 5; t += dt) {
          ASSERT_TRUE(stepper.step(dt)) << dt;
          for (const double rate : stepper.state().qd) fastest = std::max(fastest, std::abs(rate));
          highest = std::max(highest, stepper.energy());
        }
        worst = std::max(worst, highest - energy);
        parts += stepper.parts();
        EXPECT_EQ(stepper.guard_fired(), 0);
      }
      std::printf("    %s, %.4f s: %lld parts, up to %.0f rad/s, energy at most %.1e J higher\n", name(how),
                  dt, parts, fastest, worst);
      EXPECT_LE(worst, 1e-3);
      EXPECT_GT(parts, 1000);
    }
  }
}

TEST(FigureLaws, MassesOfEverySizeAreRefusedOrHandled) {
  RandomFigures random(81);
  int refused = 0, handled = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Link> links = random.model(2 + trial % 8, trial % 3 == 0).links();
    for (Link& link : links) {
      const int kind = random.below(5);
      const double factor = kind == 0 ? 0 : kind == 1 ? 1e-9 : kind == 2 ? 1e8 : kind == 3 ? 1e-3 : 1;
      link.mass *= factor;
      link.inertia *= factor;
      link.armature = 0;
    }
    try {
      const FigureModel model(links);
      FigureStepper stepper(model, random.state(model));
      FigureDynamics dynamics(model);
      std::vector<double> qdd(stepper.state().qd.size());
      dynamics.forward(stepper.state().q.data(), stepper.state().qd.data(), nullptr, qdd.data());
      EXPECT_TRUE(all_finite(qdd)) << "trial " << trial;
      for (int i = 0; i < 20; ++i) stepper.step(1.0 / 60);  // true or false, never a broken state
      EXPECT_TRUE(all_finite(stepper.state().q) && all_finite(stepper.state().qd));
      ++handled;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("permitted"), std::string::npos) << error.what();
      ++refused;
    }
  }
  std::printf("    %d handled, %d refused\n", handled, refused);
  EXPECT_GT(handled, 100);
  EXPECT_GT(refused, 10);
}

// Joints handed to dynamics and back at random, steps of 1/15 to 1/1000 s, within the ranges.
TEST(FigureLaws, RandomHandoversStayFinite) {
  std::vector<Link> links = read_amdl_file(data_file("mjhum27.amdl")).links();
  for (Link& link : links) {
    link.armature = 0.01;
    link.damping = 0.2;
  }
  const FigureModel model(links);
  RandomFigures random(91);
  FigureStepper stepper(model, rest_state(model));
  stepper.set_limits(LimitMode::kExact);
  const auto flags = std::make_unique<bool[]>(links.size());
  const int steps = by_tier(100000, 3000, 300);
  int handovers = 0;
  for (int i = 0; i < steps; ++i) {
    if (random.below(10) == 0) {
      for (std::size_t k = 0; k < links.size(); ++k) flags[k] = random.below(3) != 0;
      stepper.set_dynamic({flags.get(), links.size()});
      ++handovers;
    }
    stepper.step(1.0 / (15 + random.below(986)));
    ASSERT_TRUE(all_finite(stepper.state().q) && all_finite(stepper.state().qd)) << "step " << i;
  }
  std::printf("    %d steps, %d handovers, guard fired %lld times\n", steps, handovers,
              stepper.guard_fired());
  EXPECT_EQ(stepper.guard_fired(), 0);
}

}  // namespace
}  // namespace softpoint::figure
