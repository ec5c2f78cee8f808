#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "link_chain.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_animation.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"

namespace softpoint::figure {
namespace {

FigureModel humanoid() { return read_amdl_file(data_file("mjhum27.amdl")); }

// The humanoid with keys at 0, 1/6, 1/2 and 1 s inside its ranges, its arms dynamic from the second to the
// third, its left foot pinned.
FigureClip arms_fall(const FigureModel& model, Interpolation interpolation) {
  FigureClip clip;
  clip.end = 1;
  RandomFigures random(21);
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    JointTrack track{i, interpolation, {}};
    for (const double time : {0.0, 1.0 / 6, 0.5, 1.0}) {
      const double u = 0.5 + 0.1 * std::tanh(random.vector().x());
      if (link.joint == JointKind::kFree) {
        track.keys.push_back({time, {0, 0, 1.3, 1, 0.1 * u, 0.2 * time, 0.1}, {}});
      } else {
        track.keys.push_back({time, {link.lower + u * (link.upper - link.lower)}, {}});
      }
    }
    clip.tracks.push_back(track);
  }
  clip.dynamics = {{1.0 / 6, 0.5, {16, 17, 18, 19, 20, 21}}};
  clip.places = {{0, 1, PlaceRule::kPin, 15, {0, 0, 0}}};
  return clip;
}

std::vector<int> frames_that_changed(const FigureAnimation& animation, const std::vector<FigureState>& before,
                                     std::vector<int> links) {
  std::vector<int> changed;
  for (int k = 0; k < animation.frame_count(); ++k) {
    bool differs = false;
    for (const int link : links) {
      const auto q = static_cast<std::size_t>(animation.model().position_offset(link));
      differs = differs || animation.frame(k).q[q] != before[static_cast<std::size_t>(k)].q[q];
    }
    if (differs) changed.push_back(k);
  }
  return changed;
}

std::vector<FigureState> frames_of(const FigureAnimation& animation) {
  std::vector<FigureState> frames;
  for (int k = 0; k < animation.frame_count(); ++k) frames.push_back(animation.frame(k));
  return frames;
}

TEST(Animation, DynamicIntervalsTakeOnRatesAndHandThemOn) {
  const FigureModel model = humanoid();
  for (const Interpolation kind : {Interpolation::kCubic, Interpolation::kSmooth, Interpolation::kQuintic}) {
    AnimationSettings settings;
    settings.substeps = 4;
    FigureAnimation animation(model, arms_fall(model, kind), settings);
    animation.evaluate();
    ASSERT_EQ(animation.frame_count(), 31);
    FigureState before, after;
    for (const double seam : {1.0 / 6, 0.5}) {
      animation.sample(seam - 1e-6, before);
      animation.sample(seam + 1e-6, after);
      for (std::size_t k = 0; k < before.q.size(); ++k) EXPECT_NEAR(before.q[k], after.q[k], 2e-4);
      for (std::size_t k = 6; k < before.qd.size(); ++k) {
        EXPECT_NEAR(before.qd[k], after.qd[k], 2e-3 + 1e-4 * std::abs(after.qd[k])) << k;
      }
    }
    EXPECT_EQ(animation.counts().guard_fired, 0);
    // By keys again at the end.
    const auto q = static_cast<std::size_t>(model.position_offset(18));
    EXPECT_NEAR(animation.frame(30).q[q], animation.clip().tracks[18].keys[3].q[0], 1e-12);
    // Not by keys in between.
    EXPECT_GT(std::abs(animation.frame(15).q[q] - animation.clip().tracks[18].keys[2].q[0]), 1e-3);
  }
}

// The accelerations with which a quintic goes on are those of the dynamics.
TEST(Animation, QuinticGoesOnWithTheAccelerationOfTheDynamics) {
  const FigureModel model = humanoid();
  AnimationSettings settings;
  settings.frame_time = 1.0 / 3000;
  settings.limits = LimitMode::kNone;
  FigureAnimation animation(model, arms_fall(model, Interpolation::kQuintic), settings);
  animation.evaluate();
  const auto v = static_cast<std::size_t>(model.velocity_offset(18));
  const auto rate = [&](int k) { return animation.frame(k).qd[v]; };
  const double dt = settings.frame_time;
  const double inside = (3 * rate(1500) - 4 * rate(1499) + rate(1498)) / (2 * dt);
  const double outside = -(3 * rate(1500) - 4 * rate(1501) + rate(1502)) / (2 * dt);
  EXPECT_NEAR(inside, outside, 1e-3 * std::abs(inside));
  FigureAnimation cubic(model, arms_fall(model, Interpolation::kCubic), settings);
  cubic.evaluate();
  const double next = cubic.frame(1501).qd[v] - cubic.frame(1500).qd[v];
  EXPECT_GT(std::abs(next / dt - inside), 0.02 * std::abs(inside));
}

// A wheel that is let go slows by the paper's factor in every 1/30 s, in the paper's steps and in exact ones.
TEST(Animation, ThePapersFrictionIsTheSameInExactSteps) {
  Link wheel;
  wheel.name = "wheel";
  set_cylinder(wheel, 4.0, 0.5, 0.1);
  const FigureModel model({wheel});
  for (const double factor : {1.0, 0.8, 0.4, 0.01}) {
    for (const Integrator integrator :
         {Integrator::kPaper, Integrator::kRungeKutta4, Integrator::kDormandPrince}) {
      FigureClip clip;
      clip.end = 1;
      clip.tracks = {{0, Interpolation::kCubic, {{0, {0}, {}}, {0.5, {3}, {}}}}};
      clip.dynamics = {{0.5, 1, {0}}};
      AnimationSettings settings;
      settings.integrator = integrator;
      settings.limits = LimitMode::kNone;
      settings.substeps = 8;
      settings.paper_friction = {{0, factor}};
      FigureAnimation animation(model, clip, settings);
      animation.evaluate();
      const double first = animation.frame(15).qd[0];
      ASSERT_GT(std::abs(first), 0.1);
      for (int k = 16; k < 20; ++k) {
        EXPECT_NEAR(animation.frame(k).qd[0] / first, std::pow(factor, k - 15), 1e-4) << factor << ' ' << k;
      }
    }
  }
}

TEST(Animation, PinnedPointStays) {
  const FigureModel model = humanoid();
  FigureAnimation animation(model, arms_fall(model, Interpolation::kSmooth));
  animation.evaluate();
  const LinkChain chain(model, 15);
  const Vec3 place = chain.evaluate({0, 0, 0}, animation.frame(0).q.data(), nullptr, nullptr).position;
  for (int k = 0; k < animation.frame_count(); ++k) {
    const FigureState& state = animation.frame(k);
    const PointMotion foot = chain.evaluate({0, 0, 0}, state.q.data(), state.qd.data(), nullptr);
    EXPECT_LT((foot.position - place).norm(), 1e-14);
    EXPECT_LT(foot.velocity.norm(), 1e-13);
  }
}

// A dynamic arm on a pinned figure moves as it does on the same body hung up by a joint: the base's
// acceleration reaches it.
TEST(Animation, DynamicJointsFeelAPinnedBase) {
  // Base, leg (hinge, keyed) whose foot is pinned, arm (hinge, dynamic).
  Link base, leg, arm;
  base.name = "base";
  base.joint = JointKind::kFree;
  base.mass = 5;
  base.inertia = 0.3 * Mat3::Identity();
  leg.name = "leg";
  leg.parent = 0;
  leg.axis = Vec3::UnitX();
  leg.mass = 2;
  leg.inertia = 0.1 * Mat3::Identity();
  arm = leg;
  arm.name = "arm";
  arm.origin = {0, 0, 0.5};
  arm.center_of_mass = {0, 0, -0.3};
  arm.armature = 0;
  const FigureModel model({base, leg, arm});
  FigureClip clip;
  clip.end = 1;
  clip.tracks = {
      {1, Interpolation::kSmooth, {{0, {0}, {}}, {0.4, {0.9}, {}}, {0.7, {-0.5}, {}}, {1, {0.2}, {}}}},
      {2, Interpolation::kSmooth, {{0, {0.3}, {}}, {0.1, {0.4}, {}}}}};
  clip.dynamics = {{0.1, 1.0, {2}}};
  const Vec3 foot(0.1, 0.2, -0.8);
  clip.places = {{0, 1, PlaceRule::kPin, 1, foot}};
  AnimationSettings settings;
  settings.frame_time = 1.0 / 240;
  FigureAnimation animation(model, clip, settings);
  animation.evaluate();

  // The base turns not, so it slides along the path of the foot's opposite: prescribed prismatics.
  const double inertia = 0.1 + 2 * 0.09;  // of the arm about its shoulder
  const LinkChain chain(model, 1);
  TrackSpline spline(model, clip.tracks[0]);
  double q = animation.frame(24).q[8], v = animation.frame(24).qd[7], t = 0.1;
  const auto gain = [&](double time, double angle) {
    std::vector<double> state(model.position_count()), rates(model.velocity_count()), gains(rates.size());
    state[3] = 1;
    spline.evaluate(time, &state[7], &rates[6], &gains[6]);
    const Vec3 a = -chain.evaluate(foot, state.data(), rates.data(), gains.data()).acceleration;
    const Vec3 arm_now(0, 0.3 * std::sin(angle), -0.3 * std::cos(angle));
    const Vec3 pull = 2 * (Vec3(0, 0, -9.81) - a);
    return arm_now.cross(pull).x() / inertia;
  };
  const double h = 1e-4;
  for (int k = 0; k < 9000; ++k, t += h) {
    const double k1 = gain(t, q), k2 = gain(t + h / 2, q + h / 2 * v);
    const double k3 = gain(t + h / 2, q + h / 2 * v + h * h / 4 * k1),
                 k4 = gain(t + h, q + h * v + h * h / 2 * k2);
    q += h * v + h * h / 6 * (k1 + k2 + k3);
    v += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  EXPECT_NEAR(animation.frame(240).q[8], q, 1e-5);
  EXPECT_NEAR(animation.frame(240).qd[7], v, 1e-4);
}

TEST(Animation, AnEditSimulatesAgainOnlyWhatDependsOnIt) {
  const FigureModel model = humanoid();
  FigureAnimation animation(model, arms_fall(model, Interpolation::kCubic));
  animation.evaluate();
  EXPECT_EQ(animation.counts().dynamic_steps, 20);  // ten frames of two arms
  EXPECT_EQ(animation.counts().reused_steps, 0);
  const std::vector<FigureState> first = frames_of(animation);
  const auto edit = [&](int track, int key, double by) {
    JointKey value =
        animation.clip().tracks[static_cast<std::size_t>(track)].keys[static_cast<std::size_t>(key)];
    value.q[0] += by;
    animation.set_key(track, key, value);
    const long long before = animation.counts().dynamic_steps;
    animation.evaluate();
    return animation.counts().dynamic_steps - before;
  };
  EXPECT_EQ(edit(18, 1, 0.0), 0);    // nothing changed
  EXPECT_EQ(edit(18, 1, 0.05), 10);  // the right arm's start: the left arm is spared
  EXPECT_TRUE(frames_that_changed(animation, first, {19, 20, 21}).empty());
  EXPECT_EQ(edit(18, 1, -0.05), 10);
  EXPECT_EQ(edit(18, 3, 0.05), 0);   // after the dynamics
  EXPECT_EQ(edit(18, 2, 0.05), 0);   // passed over
  EXPECT_EQ(edit(12, 3, 0.05), 20);  // the pinned leg's last key turns its path from the second on: both arms
  EXPECT_EQ(edit(5, 2, 0.05), 0);    // the other leg carries nothing
  // What was spared is what a whole new evaluation gives, bit for bit.
  FigureAnimation fresh(model, animation.clip());
  fresh.evaluate();
  for (int k = 0; k < fresh.frame_count(); ++k) {
    EXPECT_EQ(fresh.frame(k).q, animation.frame(k).q) << k;
    EXPECT_EQ(fresh.frame(k).qd, animation.frame(k).qd) << k;
  }
}

TEST(Animation, WhollyKeyedDoesNoDynamics) {
  const FigureModel model = humanoid();
  FigureClip clip = arms_fall(model, Interpolation::kCubic);
  clip.dynamics.clear();
  FigureAnimation animation(model, clip);
  animation.evaluate();
  EXPECT_EQ(animation.counts().forward_calls, 0);
  EXPECT_EQ(animation.counts().dynamic_steps, 0);
}

TEST(Animation, RefusesWhatDoesNotFit) {
  const FigureModel model = humanoid();
  const FigureClip clip = arms_fall(model, Interpolation::kCubic);
  const auto refused = [&](auto change) {
    FigureClip bad = clip;
    change(bad);
    EXPECT_THROW(FigureAnimation(model, bad), Error);
  };
  refused([](FigureClip& c) { c.end = 0; });
  refused([](FigureClip& c) { c.tracks.push_back(c.tracks[0]); });
  refused([](FigureClip& c) { c.dynamics[0].links.clear(); });
  refused([](FigureClip& c) { c.dynamics[0].links = {0}; });
  refused([](FigureClip& c) { c.dynamics[0].links = {22}; });
  refused([](FigureClip& c) { c.dynamics.push_back({0.4, 0.6, {16}}); });
  refused([](FigureClip& c) { c.dynamics[0].end = 1.5; });
  refused([](FigureClip& c) { c.places.push_back({0.5, 0.6, PlaceRule::kKeyed, 0, {0, 0, 0}}); });
  refused([](FigureClip& c) { c.places[0].link = -1; });
  AnimationSettings settings;
  settings.integrator = Integrator::kPaper;  // wants the paper's limits
  EXPECT_THROW(FigureAnimation(model, clip, settings), Error);
}

}  // namespace
}  // namespace softpoint::figure
