// Pinned points under dynamics: loops closed by forces, against figures that have the same loop as joints,
// and the laws of what holds them.
#include <gtest/gtest.h>

#include "link_chain.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_animation.h"
#include "softpoint/figure/figure_stepper.h"
#include "softpoint/figure/swing_twist.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

Link bar(const char* link_name, int parent, const Vec3& origin, double length) {
  Link link;
  link.name = link_name;
  link.parent = parent;
  link.axis = Vec3::UnitY();
  link.origin = origin;
  set_cylinder(link, 2 * length, 0.03, length);
  link.center_of_mass = -link.center_of_mass;
  return link;
}

Vec3 point_of(const FigureModel& model, int link, const Vec3& point, const FigureState& state) {
  return LinkChain(model, link).evaluate(point, state.q.data(), nullptr, nullptr).position;
}

// A body pinned at two points turns about the line through them: six rows, one of them idle.
TEST(Pins, ABodyHeldAtTwoPointsIsOnAHinge) {
  Link free = bar("body", -1, Vec3::Zero(), 0.9);
  free.joint = JointKind::kFree;
  Link hinge = bar("body", -1, Vec3::Zero(), 0.9);
  const FigureModel loose(std::vector<Link>{free}), hung(std::vector<Link>{hinge});
  FigureStepper one(loose, rest_state(loose), Integrator::kDormandPrince);
  FigureStepper two(hung, {{0}, {4.0}}, Integrator::kDormandPrince);
  FigureState turning = rest_state(loose);
  turning.qd[1] = 4.0;
  one.set_state(turning);
  one.set_pins({{0, {0, -0.2, 0}, {0, -0.2, 0}}, {0, {0, 0.3, 0}, {0, 0.3, 0}}});
  double off = 0;
  for (int i = 0; i < 960; ++i) {
    ASSERT_TRUE(one.step(1.0 / 480));
    ASSERT_TRUE(two.step(1.0 / 480));
    const std::vector<double>& q = one.state().q;
    off = std::max(
        off, std::abs(std::remainder(2 * std::atan2(q[5], q[3]) - two.state().q[0], 4 * std::acos(0.0))));
    off = std::max(off, Vec3(q[0], q[1], q[2]).norm());
  }
  std::printf("    off by %.1e\n", off);
  EXPECT_LE(off, 1e-10);
}

// Two cranks and a coupler as a chain of three whose end is pinned: all of it goes as one pendulum.
TEST(Pins, AParallelogramIsAPendulum) {
  const double length = 0.7, wide = 0.5, angle = 0.8;
  std::vector<Link> links = {bar("left", -1, Vec3::Zero(), length), bar("coupler", 0, {0, 0, -length}, wide),
                             bar("right", 1, {wide, 0, 0}, length)};
  links[1].center_of_mass = {wide / 2, 0, 0};
  links[1].inertia = Vec3(0.001, 0.02, 0.02).asDiagonal();
  links[2].center_of_mass = -links[2].center_of_mass;  // upward
  const FigureModel chain(links);
  Link pendulum = links[0];
  const double crank = links[0].mass, coupler = links[1].mass;
  pendulum.mass = 2 * crank + coupler;
  pendulum.center_of_mass = {0, 0, -(crank * length + coupler * length) / pendulum.mass};
  const double about = 2 * (links[0].inertia(1, 1) + crank * length * length / 4) + coupler * length * length;
  const double inside = about - pendulum.mass * pendulum.center_of_mass.squaredNorm();
  pendulum.inertia = Vec3(inside, inside, 0.01).asDiagonal();
  const FigureModel single({pendulum});
  FigureStepper one(chain, {{angle, -angle, angle}, {0, 0, 0}}, Integrator::kDormandPrince);
  one.set_pins({{2, {0, 0, length}, {wide, 0, 0}}});
  FigureStepper two(single, {{angle}, {0}}, Integrator::kDormandPrince);
  double off = 0, held = 0;
  for (int i = 0; i < 960; ++i) {
    ASSERT_TRUE(one.step(1.0 / 480));
    ASSERT_TRUE(two.step(1.0 / 480));
    const std::vector<double>& q = one.state().q;
    off = std::max({off, std::abs(q[0] - two.state().q[0]), std::abs(q[0] + q[1]), std::abs(q[1] + q[2])});
    held = std::max(held, (point_of(chain, 2, {0, 0, length}, one.state()) - Vec3(wide, 0, 0)).norm());
  }
  std::printf("    off by %.1e rad, pin by %.1e m\n", off, held);
  EXPECT_LE(off, 1e-9);
  EXPECT_LE(held, 1e-13);
}

// The limp humanoid with both feet held, its joints within their ranges or not.
struct Held {
  FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  std::vector<PinnedPoint> pins;
  FigureState start = rest_state(model);
  Held() {
    for (int i = 1; i < model.link_count(); ++i) {
      const Link& link = model.links()[static_cast<std::size_t>(i)];
      start.q[static_cast<std::size_t>(model.position_offset(i))] =
          0.7 * std::clamp(0.0, link.lower, link.upper) + 0.3 * 0.5 * (link.lower + link.upper);
    }
    start.q[2] = 1.4;
    for (const char* foot : {"ankle_x_right", "ankle_x_left"}) {
      const int link = model.find(foot);
      const Vec3 sole(0.05, 0, -0.05);
      pins.push_back({link, sole, point_of(model, link, sole, start)});
    }
  }
};

TEST(Pins, TwoFeetAreHeldWhileTheRestFallsLimp) {
  const Held held;
  const double mass = held.model.total_mass();
  for (const bool limited : {false, true}) {
    FigureStepper stepper(held.model, held.start, Integrator::kDormandPrince);
    if (limited) stepper.set_limits(LimitMode::kExact);
    stepper.set_pins(held.pins);
    const double energy = stepper.energy();
    const double h = 1.0 / 960;
    double moved = 0, drift = 0, momentum = 0, moment = 0, gain = -1e300, last = energy, outside = 0;
    const auto sums = [&] {
      stepper.dynamics().place(stepper.state().q.data(), stepper.state().qd.data());
      return stepper.dynamics().mechanics();
    };
    FigureMechanics before = sums();
    for (int i = 0; i < 480; ++i) {
      ASSERT_TRUE(stepper.step(h));
      for (const PinnedPoint& pin : held.pins) {
        moved =
            std::max(moved, (point_of(held.model, pin.link, pin.point, stepper.state()) - pin.place).norm());
      }
      const FigureMechanics after = sums();
      Vec3 given = mass * h * Vec3(0, 0, -9.81), turned = Vec3::Zero();
      for (std::size_t k = 0; k < 2; ++k) {
        given += stepper.pin_impulses()[k];
        turned += held.pins[k].place.cross(stepper.pin_impulses()[k]);
      }
      turned += h * 0.5 * (before.center_of_mass + after.center_of_mass).cross(mass * Vec3(0, 0, -9.81));
      momentum = std::max(momentum, (after.momentum - before.momentum - given).norm());
      moment = std::max(moment, (after.angular_momentum - before.angular_momentum - turned).norm());
      const double now = after.kinetic_energy + after.potential_energy;
      drift = std::max(drift, std::abs(now - energy));
      gain = std::max(gain, now - last);
      last = now;
      before = after;
      if (limited) outside = std::max(outside, outside_ranges(held.model, stepper.state()));
    }
    std::printf(
        "    %s: feet moved %.1e m; a step's momentum off by %.1e N s, %.1e N m s; energy %.1e J, "
        "gain %.1e J, %lld impacts\n",
        limited ? "stops" : "free", moved, momentum, moment, drift, gain, stepper.limit_counts().impacts);
    EXPECT_LE(moved, 1e-12);
    EXPECT_LE(outside, 1e-10);
    EXPECT_LE(gain, 1e-6);
    EXPECT_EQ(stepper.limit_counts().unfinished + stepper.limit_counts().capped, 0);
    if (limited) {
      EXPECT_GE(stepper.limit_counts().impacts, 3);
    } else {
      EXPECT_LE(momentum, 1e-8);
      EXPECT_LE(moment, 1e-6);  // the trapezoid's own
      EXPECT_LE(drift, 1e-6);
    }
  }
}

TEST(Pins, OrderFourHoldsWithALoop) {
  const Held held;
  const auto end = [&](Integrator integrator, int steps) {
    FigureStepper stepper(held.model, held.start, integrator);
    stepper.set_pins(held.pins);
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(stepper.step(0.25 / steps));
    return stepper.state().q;
  };
  const std::vector<double> exact = end(Integrator::kDormandPrince, 1280);
  const auto off = [&](Integrator integrator, int steps) {
    const std::vector<double> q = end(integrator, steps);
    double worst = 0;
    for (std::size_t k = 0; k < q.size(); ++k) worst = std::max(worst, std::abs(q[k] - exact[k]));
    return worst;
  };
  const double coarse = off(Integrator::kRungeKutta4, 160), fine = off(Integrator::kRungeKutta4, 320);
  std::printf("    %.2e to %.2e, order %.2f\n", coarse, fine, std::log2(coarse / fine));
  EXPECT_GT(std::log2(coarse / fine), 3.5);
}

// The same as a rule of a clip: keyed up to 0.2 s, then limp with both feet held, one foot alone in the end.
TEST(Pins, AClipHoldsTwoFeet) {
  const Held held;
  FigureClip clip;
  clip.end = 0.8;
  for (int i = 0; i < held.model.link_count(); ++i) {
    const auto q = held.start.q.begin() + held.model.position_offset(i);
    const int count = position_count(held.model.links()[static_cast<std::size_t>(i)].joint);
    clip.tracks.push_back({i, Interpolation::kCubic, {{0, {q, q + count}, {}}, {0.8, {q, q + count}, {}}}});
  }
  const PinnedPoint &right = held.pins[0], &left = held.pins[1];
  clip.dynamics = {{0.2, 0.8, {}}};
  for (int i = 1; i < held.model.link_count(); ++i) clip.dynamics[0].links.push_back(i);
  clip.places = {{0.2, 0.6, PlaceRule::kHold, right.link, right.point, left.link},
                 {0.6, 0.8, PlaceRule::kHold, left.link, left.point, -1}};
  AnimationSettings settings;
  settings.substeps = 8;
  FigureAnimation animation(held.model, clip, settings);
  animation.evaluate();
  double moved = 0, fallen = 0;
  for (int k = 6; k < animation.frame_count(); ++k) {
    const FigureState& now = animation.frame(k);
    moved = std::max(moved, (point_of(held.model, left.link, left.point, now) - left.place).norm());
    const bool both = k <= 18;
    if (both)
      moved = std::max(moved, (point_of(held.model, right.link, right.point, now) - right.place).norm());
    EXPECT_LE(outside_ranges(held.model, now), 1e-10);
    fallen = std::max(fallen, 1.4 - now.q[2]);
  }
  FigureDynamics dynamics(held.model);
  const FigureState& last = animation.frame(animation.frame_count() - 1);
  dynamics.place(last.q.data(), last.qd.data());
  const Vec3 wanted = animation.counts().impulse + 0.6 * held.model.total_mass() * Vec3(0, 0, -9.81);
  const double momentum = (dynamics.mechanics().momentum - wanted).norm();
  std::printf("    feet moved %.1e m, root fell %.2f m, momentum off by %.1e of %.0f N s\n", moved, fallen,
              momentum, animation.counts().impulse.norm());
  EXPECT_LE(moved, 1e-10);
  EXPECT_GT(fallen, 0.2);
  EXPECT_LE(momentum, 1e-3);
  EXPECT_EQ(animation.counts().guard_fired, 0);
  clip.places[0].other = right.link;
  expect_refusal([&] { animation.set_clip(clip); }, {"place 0 other", "held already"});
}

// A chain that is taut between its ends has no way to go, whatever it is told: it must not tear.
TEST(Pins, ATautChainStaysFinite) {
  const FigureModel model = read_amdl_file(data_file("chain4ball.amdl"));
  FigureState start = rest_state(model);
  FigureStepper stepper(model, start);
  const int last = model.link_count() - 1;
  stepper.set_pins({{last, Vec3(0, 0, -0.4), point_of(model, last, {0, 0, -0.4}, start)}});
  for (std::size_t i = 0; i < start.qd.size(); ++i) start.qd[i] = i % 2 == 0 ? 2.0 : -1.0;
  stepper.set_state(start);
  const double begun = stepper.energy();
  double energy = begun;
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(stepper.step(1.0 / 240));
    energy = std::max(energy, stepper.energy());
  }
  EXPECT_GE(stepper.limit_counts().taut, 1);
  const Vec3 end = point_of(model, last, {0, 0, -0.4}, stepper.state());
  std::printf("    energy at most %.2g J, %lld steps stopped, end off by %.1e m\n", energy,
              stepper.limit_counts().taut,
              (end - point_of(model, last, {0, 0, -0.4}, rest_state(model))).norm());
  EXPECT_LE(energy, begun + 1);
  EXPECT_LE((end - point_of(model, last, {0, 0, -0.4}, rest_state(model))).norm(), 1e-6);
}

TEST(Pins, WhatCannotBeHeldIsRefused) {
  const Held held;
  FigureStepper stepper(held.model, held.start);
  std::vector<PinnedPoint> pins = held.pins;
  pins[1].place.x() += 0.01;
  expect_refusal([&] { stepper.set_pins(pins); }, {"pin on link", "distance", "0.01", "1e-06"});
  pins = held.pins;
  pins[0].link = 99;
  expect_refusal([&] { stepper.set_pins(pins); }, {"pin link = 99"});
  FigureStepper variational(held.model, held.start, Integrator::kVariational);
  expect_refusal([&] { variational.set_pins(held.pins); }, {"pins with the integrator variational"});
  FigureStepper paper(held.model, held.start, Integrator::kPaper);
  paper.set_limits(LimitMode::kPaper);
  expect_refusal([&] { paper.set_pins(held.pins); }, {"pins with limits paper"});
}

}  // namespace
}  // namespace softpoint::figure
