// Swing and twist of balls: what their rows are made of against differences, what is refused, how it is read.
#include <gtest/gtest.h>

#include <numbers>
#include <sstream>

#include "ball_range.h"
#include "cone_chain.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_stepper.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

TEST(BallRange, SwingAndTwistComeBackFromTheTurn) {
  const FigureModel model = cone_chain(3, true);
  RandomFigures random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Link& link = model.links()[1 + static_cast<std::size_t>(trial % 3)];
    SwingTwist turn;
    const Vec3 v = random.vector();
    turn.swing = v - v.dot(link.axis) * link.axis;
    turn.swing *= 3.0 * random.below(1000) / 1000 / turn.swing.norm();
    turn.twist = -3 + 0.006 * random.below(1000);
    double q[4];
    set_swing_twist(link, turn, q);
    const Eigen::Quaterniond one(q[0], q[1], q[2], q[3]);
    const auto exp = [](const Vec3& r) {
      return Eigen::Quaterniond(
          Eigen::AngleAxisd(r.norm(), r.norm() > 0 ? Vec3(r.normalized()) : Vec3::UnitX()));
    };
    EXPECT_LE(one.angularDistance(exp(turn.swing) * exp(turn.twist * link.axis)), 1e-7);
    const SwingTwist back = swing_twist(link, q);
    EXPECT_LE((back.swing - turn.swing).norm() + std::abs(back.twist - turn.twist), 1e-12);
  }
}

// Rows of both ranges along a turn at an even spin, against central differences of fourth order.
TEST(BallRange, GradientsAndSecondDerivativesAgreeWithDifferences) {
  RandomFigures random(11);
  double first = 0, second = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const FigureModel model = cone_chain(3, false);
    Link link = model.links()[static_cast<std::size_t>(trial % 3)];
    if (trial % 2 == 0) link.swing_about = link.swing_across = 2.9;  // swings of up to 2.9 rad
    if (trial % 7 == 0) link.swing_about = link.swing_across = 0.02;
    link.parent = -1;
    const FigureModel one({link});
    const FigureState state = random_inside(one, random, 1.0);
    const BallRange range(one.links()[0]);
    const Vec3 spin(state.qd[0], state.qd[1], state.qd[2]);
    const Eigen::Quaterniond q(state.q[0], state.q[1], state.q[2], state.q[3]);
    const auto at = [&](double t) {
      const Eigen::Quaterniond moved =
          q * Eigen::Quaterniond(Eigen::AngleAxisd(t * spin.norm(), spin.normalized()));
      const double numbers[4] = {moved.w(), moved.x(), moved.y(), moved.z()};
      return range.turn(numbers);
    };
    const double h = 1e-3 * std::min(1.0, (std::numbers::pi - range.swing(at(0)).norm()) / spin.norm());
    const auto check = [&](auto value, const BallRange::Row& row) {
      const double a = value(at(-2 * h)), b = value(at(-h)), c = value(at(0)), d = value(at(h)),
                   e = value(at(2 * h));
      const double rate = (a - 8 * b + 8 * d - e) / (12 * h);
      const double gain = (-a + 16 * b - 30 * c + 16 * d - e) / (12 * h * h);
      const double size = 1 + std::abs(gain) + std::abs(rate);
      first = std::max(first, std::abs(rate - row.gradient.dot(spin)) / size);
      second = std::max(second, std::abs(gain - row.bias) / size);
    };
    check([&](const BallRange::Turn& t) { return range.excess(t); }, range.swing_row(at(0), spin));
    check([&](const BallRange::Turn& t) { return t.twist; }, range.twist_row(at(0), spin));
  }
  std::printf("    rates off by %.1e, second derivatives by %.1e\n", first, second);
  EXPECT_LE(first, 1e-9);
  EXPECT_LE(second, 1e-6);
}

TEST(BallRange, WhatCannotBeMeantIsRefused) {
  const auto with = [](auto change) {
    Link link = ball_link("hip", -1, 0.4);
    link.swing_about = 0.5;
    link.swing_across = 0.7;
    change(link);
    return [link] { FigureModel({link}); };
  };
  expect_refusal(with([](Link& l) { l.swing_about = 3.1; }), {"'hip' swing_about", "3.1", "0.01 to 3"});
  expect_refusal(with([](Link& l) { l.swing_across = 1e9; }), {"'hip' swing_across", "0.01 to 3"});
  expect_refusal(with([](Link& l) { l.lower = -3.5; }), {"'hip' lower", "-3.5", "-3 to"});
  expect_refusal(with([](Link& l) { l.lower = 1, l.upper = 0.5; }), {"'hip' upper", "0.5"});
  expect_refusal(with([](Link& l) { l.swing_axis = l.axis; }), {"'hip' swing_axis", "not that of axis"});
  expect_refusal(with([](Link& l) { l.swing_about = l.swing_across = 1e9, l.lower = -1; }),
                 {"'hip' lower", "swing is free"});
  expect_refusal(with([](Link& l) { l.joint = JointKind::kHinge; }), {"'hip' swing_about", "hinge"});
  const FigureModel model = cone_chain(1, false);
  FigureStepper variational(model, rest_state(model), Integrator::kVariational);
  expect_refusal([&] { variational.set_limits(LimitMode::kExact); }, {"variational", "rk4"});
  FigureState out = rest_state(model);
  out.q = {std::cos(0.7), std::sin(0.7), 0, 0};
  FigureStepper stepper(model, rest_state(model));
  stepper.set_limits(LimitMode::kExact);
  expect_refusal([&] { stepper.set_state(out); }, {"'b0' q", "1.4", "permitted is a cone"});
}

TEST(BallRange, TheReaderTakesAConeAfterTheRange) {
  std::istringstream good("hip -1 2 0 0 2 0 0 1 1.5 0 0 -0.2 .02 .02 .006 0 0 0 -0.3 0.4 0.5 0.7 1 0 0\n");
  const Link link = read_amdl(good, "cone").links()[0];
  EXPECT_EQ(link.swing_about, 0.5);
  EXPECT_EQ(link.swing_across, 0.7);
  EXPECT_EQ(link.lower, -0.3);
  EXPECT_EQ(link.axis, Vec3(Vec3::UnitZ()));
  EXPECT_EQ(link.swing_axis, Vec3(Vec3::UnitX()));
  std::istringstream wide("hip -1 2 0 0 1 0 0 1 1.5 0 0 -0.2 .02 .02 .006 0 0 0 -0.3 0.4 0.5 9 1 0 0\n");
  expect_refusal([&] { read_amdl(wide, "cone"); }, {"cone", "'hip' swing_across = 9", "0.01 to 3"});
  std::istringstream cut("hip -1 2 0 0 1 0 0 1 1.5 0 0 -0.2 .02 .02 .006 0 0 0 -0.3 0.4 0.5\n");
  expect_refusal([&] { read_amdl(cut, "cone"); }, {"line 1", "swing_across is no number"});
}

}  // namespace
}  // namespace softpoint::figure
