// Friction of joints: dry, against what a wheel and a pendulum must do; viscous, at any step; energy never
// rises by either.
#include <gtest/gtest.h>

#include <cstdlib>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/refusal.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

FigureModel with_friction(const std::string& file, double dry, double viscous) {
  std::vector<Link> links = read_amdl_file(data_file(file)).links();
  for (Link& link : links) {
    if (link.joint != JointKind::kHinge) continue;
    link.friction = dry;
    link.damping = viscous;
    link.armature = 0.01;
  }
  return FigureModel(links);
}

// A wheel on an axle slows evenly and stops after w^2 I / (2 c).
TEST(DryFriction, AWheelSlowsEvenlyAndStopsForGood) {
  Link wheel;
  wheel.name = "wheel";
  set_cylinder(wheel, 4.0, 0.5, 0.1);  // 0.5 kg m2 about z
  wheel.friction = 0.2;
  const FigureModel model({wheel});
  for (const Integrator integrator :
       {Integrator::kPaper, Integrator::kRungeKutta4, Integrator::kDormandPrince, Integrator::kVariational}) {
    FigureStepper stepper(model, {{0}, {3}}, integrator);
    double worst = 0;
    for (int i = 1; i <= 600; ++i) {
      stepper.step(1.0 / 60);
      const double t = std::min(i / 60.0, 7.5);
      if (i < 440 || i > 460) worst = std::max(worst, std::abs(stepper.state().qd[0] - (3 - 0.4 * t)));
    }
    std::printf("    %s: rate off by %.1e, angle by %.1e\n", name(integrator), worst,
                std::abs(stepper.state().q[0] - 11.25));
    EXPECT_LE(worst, 1e-12);
    EXPECT_EQ(stepper.state().qd[0], 0);
    EXPECT_NEAR(stepper.state().q[0], 11.25, integrator == Integrator::kPaper ? 0.05 : 1e-3);
    EXPECT_EQ(stepper.limit_counts().unfinished, 0);
  }
}

// Where friction bears the weight a pendulum stays to the last digit; where it does not, it falls until it
// does.
TEST(DryFriction, HoldsAPendulumOrLetsItFall) {
  for (const LimitMode limits : {LimitMode::kNone, LimitMode::kExact}) {
    const FigureModel model = with_friction("pend2.amdl", 8.0, 0.0);
    FigureStepper stepper(model, {{0.3, 0.2}, {0, 0}});
    stepper.set_limits(limits);
    for (int i = 0; i < 300; ++i) stepper.step(1.0 / 60);
    EXPECT_EQ(stepper.state().q, (std::vector<double>{0.3, 0.2}));
    EXPECT_EQ(stepper.state().qd, (std::vector<double>{0, 0}));
    stepper.set_state({{1.5, 0.2}, {0, 0}});
    double energy = stepper.energy();
    for (int i = 0; i < 1200; ++i) {
      stepper.step(1.0 / 60);
      EXPECT_LE(stepper.energy(), energy + 1e-5);
      energy = stepper.energy();
    }
    EXPECT_EQ(stepper.state().qd, (std::vector<double>{0, 0}));
    EXPECT_LT(std::abs(stepper.state().q[0]), 1.2);
    EXPECT_EQ(stepper.limit_counts().unfinished, 0);
  }
}

// Without gravity nothing but friction and stops changes a figure's energy, and they only take from it.
TEST(DryFriction, KineticEnergyNeverRises) {
  const FigureModel model = with_friction("mjhum27.amdl", 0.4, 0.05);
  RandomFigures random(101);
  double rise = -1e300, integration = 0;
  long long unfinished = 0, guard = 0;
  int rested = 0;
  for (int trial = 0; trial < by_tier(300, 12, 4); ++trial) {
    FigureState start = rest_state(model);
    for (int i = 1; i < model.link_count(); ++i) {
      const Link& link = model.links()[static_cast<std::size_t>(i)];
      start.q[static_cast<std::size_t>(model.position_offset(i))] =
          link.lower + (0.5 + 0.4 * std::tanh(random.vector().x())) * (link.upper - link.lower);
    }
    for (double& v : start.qd) v = random.vector().x();
    FigureStepper stepper(model, start);
    stepper.dynamics().set_gravity(Vec3::Zero());
    if (trial % 2 == 1) stepper.set_limits(LimitMode::kExact);
    double energy = stepper.energy();
    const double first = energy;
    for (int i = 0; i < 240; ++i) {
      stepper.step(1.0 / 240);
      const double now = stepper.energy();
      rise = std::max(rise, (now - energy) / first);
      energy = now;
    }
    integration = std::max(integration, energy / first);
    unfinished += stepper.limit_counts().unfinished;
    guard += stepper.guard_fired();
    int still = 0;
    for (std::size_t k = 6; k < stepper.state().qd.size(); ++k) still += stepper.state().qd[k] == 0;
    rested += still > 15;
  }
  std::printf(
      "    largest rise in a step %.1e of the first energy, left at most %.2f of it, %d came to rest\n", rise,
      integration, rested);
  EXPECT_LE(rise, 1e-7);  // of the integrator, between the impulses
  EXPECT_EQ(unfinished, 0);
  EXPECT_EQ(guard, 0);
  EXPECT_GT(rested, 0);
}

TEST(ViscousFriction, ThePapersStepIsImplicitInIt) {
  const FigureModel model = with_friction("pend2.amdl", 0.0, 1e5);
  FigureStepper stepper(model, {{0.5, -0.3}, {3, -2}}, Integrator::kPaper);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(stepper.step(1.0 / 30));
  EXPECT_NEAR(stepper.state().q[0], 0.5, 0.01);
  EXPECT_LT(std::abs(stepper.state().qd[0]), 1e-3);
}

// Whatever the friction and the step: nothing is lost, energy never rises but by what the integrator misses
// without friction too, and what creeps creeps as it should.
TEST(ViscousFriction, IsStableAtAnyStep) {
  for (const Integrator integrator : {Integrator::kRungeKutta4, Integrator::kDormandPrince}) {
    for (const double dt : {1.0 / 15, 1.0 / 30, 1.0 / 60, 1.0 / 240, 1.0 / 1000}) {
      double own = 0, worst = 0, worst_at = 0;
      for (double viscous = 1e-4; viscous < 2e6; viscous *= 10) {
        const double damping = viscous < 5e-4 ? 0.0 : viscous;
        for (const bool free : {false, true}) {
          std::vector<Link> links = read_amdl_file(data_file(free ? "mjhum27.amdl" : "pend2.amdl")).links();
          for (Link& link : links) {
            if (link.joint == JointKind::kHinge) link.damping = damping;
            if (free) link.armature = 0.01;
          }
          const FigureModel model(links);
          FigureState start = rest_state(model);
          RandomFigures random(4);
          for (double& v : start.qd) v = 1.5 * random.vector().x();
          if (!free) start.q[0] = 1.2;
          FigureStepper stepper(model, start, integrator);
          if (free) stepper.dynamics().set_gravity(Vec3::Zero());
          double energy = stepper.energy();
          const double scale = free ? energy : 10.0;  // J
          for (int i = 0; i < 45; ++i) {
            ASSERT_TRUE(stepper.step(dt)) << name(integrator) << ' ' << dt << ' ' << damping;
            const double now = stepper.energy(), rise = (now - energy) / scale;
            energy = now;
            if (damping == 0) own = std::max(own, rise);
            if (damping > 0 && rise > worst) {
              worst = rise;
              worst_at = damping;
            }
          }
          EXPECT_EQ(stepper.guard_fired(), 0);
        }
      }
      std::printf("    %s, %.4f s: energy rises by %.1e (damping %g), without friction by %.1e\n",
                  name(integrator), dt, worst, worst_at, own);
      // At 1/15 s integrators err by as much either way, and more on some ways than on others.
      EXPECT_LE(worst, own + (dt > 0.05 ? 1e-3 : 1e-9));
    }
  }
}

// Order 4 where friction is gentle within a step, which it becomes with shorter ones; on the way there, with
// friction that stops the joints within a step, errors stay small.
TEST(ViscousFriction, KeepsTheOrder) {
  for (const double damping : {0.5, 50.0}) {
    std::vector<Link> links = read_amdl_file(data_file("pend2.amdl")).links();
    for (Link& link : links) link.damping = damping;
    const FigureModel model(links);
    const auto after = [&](int steps, Integrator integrator) {
      FigureStepper stepper(model, {{1.2, -0.4}, {1, -2}}, integrator);
      for (int i = 0; i < steps; ++i) stepper.step(0.5 / steps);
      return stepper.state().q;
    };
    const auto exact = after(8000, Integrator::kDormandPrince);
    const auto error = [&](int steps) {
      const auto q = after(steps, Integrator::kRungeKutta4);
      return std::hypot(q[0] - exact[0], q[1] - exact[1]);
    };
    const int fine = damping < 1 ? 128 : 2048;
    const double order = std::log2(error(fine / 2) / error(fine));
    double coarse = 0;
    for (int steps = 4; steps < 64; steps *= 2) coarse = std::max(coarse, error(steps));
    std::printf("    damping %g: order %.2f, coarse steps off by %.1e rad\n", damping, order, coarse);
    EXPECT_NEAR(order, 4, 0.2);
    EXPECT_LE(coarse, damping < 1 ? 4e-3 : 3e-6);
  }
}

TEST(DryFriction, IsRefusedWhereItHasNoMeaning) {
  Link ball;
  ball.name = "ball";
  ball.joint = JointKind::kBall;
  set_cylinder(ball, 1, 0.1, 0.5);
  ball.friction = 1;
  expect_refusal([&] { FigureModel({ball}); }, {"link 0 'ball' friction = 1", "permitted", "hinge"});
  ball.joint = JointKind::kHinge;
  ball.friction = -1;
  expect_refusal([&] { FigureModel({ball}); }, {"friction = -1", "permitted"});
}

}  // namespace
}  // namespace softpoint::figure
