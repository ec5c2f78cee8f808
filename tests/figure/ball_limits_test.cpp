// Balls within cones of swing and ranges of twist: a pendulum on its cone against closed forms, and the laws
// of stops.
#include <gtest/gtest.h>

#include "cone_chain.h"
#include "many_starts.h"
#include "softpoint/figure/figure_stepper.h"
#include "support/tier.h"

namespace softpoint::figure {
namespace {

// A pendulum swung about the vertical faster than it would go by itself leans on its cone for good and goes
// round it at its even speed: nothing turns it about the vertical, nothing about its own axis.
TEST(BallLimits, APendulumGoesRoundItsConeEvenly) {
  Link link = ball_link("pendulum", -1, 0.8);
  link.swing_about = link.swing_across = 0.9;
  const FigureModel model({link});
  const double precession = 6.5;  // rad/s; 4.7 would do without a cone
  FigureState state = rest_state(model);
  const auto turned = [&](double azimuth) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(0.9, Vec3(std::cos(azimuth), std::sin(azimuth), 0)));
  };
  const Eigen::Quaterniond start = turned(0);
  state.q = {start.w(), start.x(), start.y(), start.z()};
  // Turning about the vertical less about itself, so that it never twists: R' = precession (z x) R - R (z x).
  const Vec3 spin = precession * (start.toRotationMatrix().transpose() * Vec3::UnitZ() - Vec3::UnitZ());
  state.qd = {spin.x(), spin.y(), spin.z()};
  for (const Integrator integrator : {Integrator::kRungeKutta4, Integrator::kDormandPrince}) {
    FigureStepper stepper(model, state, integrator);
    stepper.set_limits(LimitMode::kExact);
    const double energy = stepper.energy();
    double off = 0, tilt = 0;
    for (int i = 1; i <= 1200; ++i) {
      ASSERT_TRUE(stepper.step(1.0 / 480));
      const std::vector<double>& q = stepper.state().q;
      const Eigen::Quaterniond is(q[0], q[1], q[2], q[3]);
      const Vec3 axis = is * Vec3::UnitZ(), wanted = turned(precession * i / 480) * Vec3::UnitZ();
      off = std::max(off, (axis - wanted).norm());
      tilt = std::max(tilt, outside_ranges(model, stepper.state()));
    }
    std::printf("    %s: off the closed form by %.1e, outside by %.1e rad, energy by %.1e J\n",
                name(integrator), off, tilt, stepper.energy() - energy);
    EXPECT_LE(off, integrator == Integrator::kDormandPrince ? 1e-10 : 1e-6);
    EXPECT_LE(tilt, 1e-13);
    EXPECT_NEAR(stepper.energy(), energy, 1e-7);
  }
}

// In a plane through the vertical a ball with a cone is a hinge with a range.
TEST(BallLimits, InAPlaneAConeIsAHingesRange) {
  std::vector<Link> links[2];
  for (int i = 0; i < 2; ++i) {
    Link ball = ball_link(i == 0 ? "b0" : "b1", i - 1, 0.5);
    if (i > 0) ball.origin = {0, 0, -0.5};
    ball.swing_about = ball.swing_across = 0.4 + 0.2 * i;
    Link hinge = ball;
    hinge.joint = JointKind::kHinge;
    hinge.axis = Vec3::UnitX();
    hinge.lower = -ball.swing_about;
    hinge.upper = ball.swing_about;
    hinge.swing_about = hinge.swing_across = 1e9;
    links[0].push_back(ball);
    links[1].push_back(hinge);
  }
  const FigureModel balls(links[0]), hinges(links[1]);
  FigureState round = rest_state(balls), flat = rest_state(hinges);
  flat.qd = {4, -9};
  round.qd = {4, 0, 0, -9, 0, 0};
  FigureStepper one(balls, round, Integrator::kDormandPrince), two(hinges, flat, Integrator::kDormandPrince);
  one.set_limits(LimitMode::kExact);
  two.set_limits(LimitMode::kExact);
  double off = 0, late = 0;
  int events = 0;
  for (int i = 0; i < 480; ++i) {
    ASSERT_TRUE(one.step(1.0 / 240));
    ASSERT_TRUE(two.step(1.0 / 240));
    ASSERT_EQ(one.events().size(), two.events().size()) << i;
    for (std::size_t k = 0; k < one.events().size(); ++k) {
      late = std::max(late, std::abs(one.events()[k].time - two.events()[k].time));
      EXPECT_EQ(one.events()[k].link, two.events()[k].link);
      EXPECT_EQ(one.events()[k].impact, two.events()[k].impact);
      EXPECT_TRUE(one.events()[k].swing);
      ++events;
    }
    for (int j = 0; j < 2; ++j) {
      const double* q = one.state().q.data() + 4 * j;
      off = std::max(off, std::abs(2 * std::atan2(q[1], q[0]) - two.state().q[static_cast<std::size_t>(j)]));
    }
  }
  std::printf("    %d events, times off by %.1e s, angles by %.1e rad\n", events, late, off);
  EXPECT_GE(events, 6);
  EXPECT_LE(late, 1e-9);
  EXPECT_LE(off, 1e-9);
}

// Order through impacts on elliptic cones and twists, and out of them, in space.
TEST(BallLimits, OrdersHoldThroughTheEventsOfBalls) {
  const FigureModel model = cone_chain(2, false);
  FigureState state = rest_state(model);
  state.qd = {2.5, 1.5, 3, -1, 2, -1};
  const auto end = [&](Integrator integrator, int steps, int* events) {
    FigureStepper stepper(model, state, integrator);
    stepper.set_limits(LimitMode::kExact);
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(stepper.step(1.2 / steps));
      if (events != nullptr) *events += static_cast<int>(stepper.events().size());
    }
    EXPECT_EQ(stepper.limit_counts().capped + stepper.limit_counts().unfinished, 0);
    return stepper.state().q;
  };
  int events = 0;
  const std::vector<double> exact = end(Integrator::kDormandPrince, 4800, &events);
  const auto off = [&](Integrator integrator, int steps) {
    const std::vector<double> q = end(integrator, steps, nullptr);
    double worst = 0;
    for (std::size_t k = 0; k < q.size(); ++k) worst = std::max(worst, std::abs(q[k] - exact[k]));
    return worst;
  };
  const double coarse = off(Integrator::kRungeKutta4, 300), fine = off(Integrator::kRungeKutta4, 600);
  std::printf("    %d events, %.2e to %.2e, order %.2f\n", events, coarse, fine, std::log2(coarse / fine));
  EXPECT_GE(events, 5);
  EXPECT_GT(std::log2(coarse / fine), 3.5);
}

TEST(BallLimits, ManyStartsStayInsideAndEverySearchEnds) {
  expect_many_starts_stay_inside(by_tier(1000, 20, 2), 5, 2, [](RandomFigures& random, int trial) {
    const FigureModel model = cone_chain(3, trial % 2 == 0);
    return FigureStepper(model, random_inside(model, random, 3.0));
  });
}

TEST(BallLimits, ABlowNeverRaisesTheKineticEnergy) {
  RandomFigures random(9);
  double gain = -1e300;
  int blows = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const FigureModel model = cone_chain(3, trial % 2 == 0);
    FigureState state = random_inside(model, random, 3.0);
    for (int i = 0; i < model.link_count(); ++i) {
      const Link& link = model.links()[static_cast<std::size_t>(i)];
      if (link.joint != JointKind::kBall || random.coin()) continue;
      double* q = state.q.data() + model.position_offset(i);
      SwingTwist turn = swing_twist(link, q);
      const Vec3 across = link.axis.cross(link.swing_axis);
      turn.swing /= std::hypot(turn.swing.dot(link.swing_axis) / link.swing_about,
                               turn.swing.dot(across) / link.swing_across);
      if (random.coin()) turn.twist = random.coin() ? link.upper : link.lower;
      set_swing_twist(link, turn, q);
    }
    FigureStepper stepper(model, state);
    stepper.dynamics().set_gravity(Vec3::Zero());
    stepper.set_limits(LimitMode::kExact);
    const double before = stepper.energy();
    stepper.step(1e-9);
    gain = std::max(gain, (stepper.energy() - before) / before);
    blows += static_cast<int>(stepper.limit_counts().impacts);
    EXPECT_EQ(stepper.limit_counts().unfinished, 0) << trial;
  }
  std::printf("    %d blows, largest change of the energy %.1e of it\n", blows, gain);
  EXPECT_GT(blows, 150);
  EXPECT_LE(gain, 1e-6);  // of the step of 1 ns itself
}

TEST(BallLimits, ThePapersStepsKeepTheCone) {
  RandomFigures random(7);
  double violation = 0;
  LimitCounts sum;
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Link> links = cone_chain(3, false).links();
    for (Link& link : links) link.armature = 0.02;  // thin links that spin are too much for (5) and (6)
    const FigureModel model(links);
    FigureStepper stepper(model, random_inside(model, random, 3.0), Integrator::kPaper);
    stepper.set_limits(LimitMode::kPaper);
    for (int i = 0; i < 30; ++i) {
      ASSERT_TRUE(stepper.step(1.0 / 60));
      violation = std::max(violation, outside_ranges(model, stepper.state()));
    }
    sum.passes += stepper.limit_counts().passes;
    sum.wrong_sign += stepper.limit_counts().wrong_sign;
    sum.unfinished += stepper.limit_counts().unfinished;
  }
  std::printf("    paper: %lld passes in 600 steps, %lld held by a pull, %lld unfinished, outside by %.1e\n",
              sum.passes, sum.wrong_sign, sum.unfinished, violation);
  EXPECT_GT(sum.passes, 700);
  EXPECT_LE(violation, 1e-10);
  EXPECT_EQ(sum.unfinished, 0);
}

}  // namespace
}  // namespace softpoint::figure
