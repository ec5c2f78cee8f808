#include <gtest/gtest.h>

#include "link_chain.h"
#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_dynamics.h"
#include "softpoint/figure/keyframes.h"
#include "support.h"

namespace softpoint::figure {
namespace {

constexpr Interpolation kAllKinds[] = {Interpolation::kQuadratic, Interpolation::kCubic,
                                       Interpolation::kMonotone, Interpolation::kSmooth,
                                       Interpolation::kQuintic};

// One joint of a kind, on the world.
FigureModel one_joint(JointKind kind) {
  Link link;
  link.name = "link";
  link.joint = kind;
  link.mass = 1;
  link.inertia = Mat3::Identity();
  return FigureModel({link});
}

JointTrack random_track(const FigureModel& model, Interpolation interpolation, int keys, unsigned seed) {
  RandomFigures random(seed);
  JointTrack track;
  track.interpolation = interpolation;
  double time = 0.3;
  for (int i = 0; i < keys; ++i) {
    track.keys.push_back({time, random.numbers(model.position_count()), {}});
    time += 0.2 + std::abs(random.vector().x());
  }
  check_track(model, track);
  return track;
}

struct At {
  std::vector<double> q = std::vector<double>(7), qd = std::vector<double>(6), qdd = std::vector<double>(6);
};
At at(const TrackSpline& spline, double time) {
  At result;
  spline.evaluate(time, result.q.data(), result.qd.data(), result.qdd.data());
  return result;
}

// How far two orientations or places are apart.
double distance(const FigureModel& model, const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0, mirrored = 0;
  const JointKind kind = model.links()[0].joint;
  const int slides = kind == JointKind::kFree ? 3 : kind == JointKind::kBall ? 0 : 1;
  for (int k = 0; k < model.position_count(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    sum += std::pow(a[i] - b[i], 2);
    mirrored += std::pow(k < slides ? a[i] - b[i] : a[i] + b[i], 2);
  }
  return std::sqrt(std::min(sum, mirrored));
}

class Kinds : public ::testing::TestWithParam<JointKind> {};

TEST_P(Kinds, MeetTheirKeysAndRatesThatWereGiven) {
  const FigureModel model = one_joint(GetParam());
  for (const Interpolation kind : kAllKinds) {
    JointTrack track = random_track(model, kind, 5, 3);
    track.keys[0].qd = RandomFigures(8).numbers(model.velocity_count());
    if (kind != Interpolation::kQuadratic)
      track.keys[2].qd = RandomFigures(9).numbers(model.velocity_count());
    const TrackSpline spline(model, track);
    for (const JointKey& key : track.keys) {
      const At now = at(spline, key.time);
      EXPECT_LT(distance(model, now.q, key.q), 1e-13) << name(kind);
      for (std::size_t k = 0; k < key.qd.size(); ++k) EXPECT_NEAR(now.qd[k], key.qd[k], 1e-12) << name(kind);
    }
    EXPECT_LT(distance(model, at(spline, -5).q, track.keys.front().q), 1e-15);
    EXPECT_LT(distance(model, at(spline, 50).q, track.keys.back().q), 1e-13);
    EXPECT_EQ(at(spline, 50).qd[0], 0);
  }
}

// Rates and accelerations are the derivatives that they claim to be: a chain of one link, moved by the spline
// and differenced.
TEST_P(Kinds, GiveTheDerivativesOfTheirMotion) {
  const FigureModel model = one_joint(GetParam());
  const LinkChain chain(model, 0);
  for (const Interpolation kind : kAllKinds) {
    const TrackSpline spline(model, random_track(model, kind, 6, 5));
    const double h = 1e-4;
    double worst_rate = 0, worst_gain = 0;
    for (double t = 0.41; t < 3; t += 0.0937) {
      const Vec3 point(0.3, -0.2, 0.7);
      const auto place = [&](double time) {
        const At s = at(spline, time);
        return chain.evaluate(point, s.q.data(), s.qd.data(), s.qdd.data());
      };
      const PointMotion now = place(t), before = place(t - h), after = place(t + h);
      const Vec3 rate = (after.position - before.position) / (2 * h);
      const Vec3 gain = (after.velocity - before.velocity) / (2 * h);
      const bool at_key = (after.acceleration - before.acceleration).norm() > 1;  // it may jump there
      if (!at_key) {
        worst_rate = std::max(worst_rate, (rate - now.velocity).norm() / (1 + now.velocity.norm()));
        worst_gain = std::max(worst_gain, (gain - now.acceleration).norm() / (1 + now.acceleration.norm()));
      }
    }
    EXPECT_LT(worst_rate, 1e-5) << name(kind);
    EXPECT_LT(worst_gain, 1e-5) << name(kind);
  }
}

TEST_P(Kinds, SmoothAndQuinticAccelerateWithoutJumps) {
  const FigureModel model = one_joint(GetParam());
  for (const Interpolation kind : {Interpolation::kSmooth, Interpolation::kQuintic}) {
    const JointTrack track = random_track(model, kind, 6, 7);
    const TrackSpline spline(model, track);
    for (std::size_t i = 1; i + 1 < track.keys.size(); ++i) {
      const At before = at(spline, track.keys[i].time - 1e-9), after = at(spline, track.keys[i].time + 1e-9);
      for (int k = 0; k < model.velocity_count(); ++k) {
        const auto j = static_cast<std::size_t>(k);
        EXPECT_NEAR(before.qd[j], after.qd[j], 1e-5);
        EXPECT_NEAR(before.qdd[j], after.qdd[j], 1e-4 * (1 + std::abs(after.qdd[j]))) << name(kind);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Splines, Kinds,
                         ::testing::Values(JointKind::kHinge, JointKind::kPrismatic, JointKind::kBall,
                                           JointKind::kFree),
                         [](const auto& kind) { return std::string(name(kind.param)); });

TEST(Keyframes, MonotoneStaysBetweenItsKeysWhereCubicDoesNot) {
  const FigureModel model = one_joint(JointKind::kHinge);
  JointTrack track;
  track.keys = {{0, {0}, {}}, {1, {0.1}, {}}, {1.2, {2}, {}}, {2, {2.05}, {}}, {3, {2.05}, {}}};
  for (const Interpolation kind : {Interpolation::kCubic, Interpolation::kMonotone}) {
    track.interpolation = kind;
    const TrackSpline spline(model, track);
    double above = 0, falls = 0, last = 0;
    for (double t = 0; t < 3; t += 0.001) {
      const double q = at(spline, t).q[0];
      above = std::max(above, q - 2.05);
      falls = std::max(falls, last - q);
      last = q;
    }
    if (kind == Interpolation::kMonotone) {
      EXPECT_LT(above, 1e-14);
      EXPECT_LT(falls, 1e-14);
    } else {
      EXPECT_GT(std::max(above, falls), 1e-3);
    }
  }
}

// (1) of section 2.5: from theta_1, its rate and theta_2.
TEST(Keyframes, QuadraticHasOneAccelerationFromKeyToKey) {
  const FigureModel model = one_joint(JointKind::kHinge);
  JointTrack track{0, Interpolation::kQuadratic, {{0, {1}, {0.5}}, {2, {3}, {}}}};
  const TrackSpline spline(model, track);
  const double a = 2 * (3 - 1 - 0.5 * 2) / 4;
  for (const double t : {0.0, 0.7, 1.9}) {
    EXPECT_NEAR(at(spline, t).q[0], 1 + 0.5 * t + 0.5 * a * t * t, 1e-14);
    EXPECT_NEAR(at(spline, t).qdd[0], a, 1e-13);
  }
}

TEST(Keyframes, RefusesTracksThatDoNotFit) {
  const FigureModel model = one_joint(JointKind::kBall);
  JointTrack track{0, Interpolation::kCubic, {{0, {2, 0, 0, 0}, {}}, {1, {0, 1, 0, 0}, {}}}};
  check_track(model, track);
  EXPECT_EQ(track.keys[0].q[0], 1);
  const auto refused = [&](auto change) {
    JointTrack bad = track;
    change(bad);
    EXPECT_THROW(check_track(model, bad), Error);
  };
  refused([](JointTrack& t) { t.keys.clear(); });
  refused([](JointTrack& t) { t.link = 1; });
  refused([](JointTrack& t) { t.keys[1].time = 0; });
  refused([](JointTrack& t) { t.keys[1].q = {0, 0, 0, 0}; });
  refused([](JointTrack& t) { t.keys[1].q.pop_back(); });
  refused([](JointTrack& t) { t.keys[1].qd = {1, 2}; });
  refused([](JointTrack& t) { t.keys[0].q[1] = NAN; });
}

TEST(LinkChain, MovesAsTheDynamicsSay) {
  RandomFigures random(11);
  for (int trial = 0; trial < 20; ++trial) {
    const FigureModel model = random.model(9, trial % 2 == 0);
    const FigureState state = random.state(model);
    const std::vector<double> qdd = random.numbers(model.velocity_count());
    FigureDynamics dynamics(model);
    dynamics.place(state.q.data(), state.qd.data());
    for (int link = 0; link < model.link_count(); ++link) {
      const LinkChain chain(model, link);
      const PointMotion m = chain.evaluate(Vec3::Zero(), state.q.data(), state.qd.data(), qdd.data());
      const LinkMotion other = dynamics.motion(link);
      EXPECT_LT((m.position - other.position).norm(), 1e-13);
      EXPECT_LT((m.velocity - other.velocity).norm(), 1e-12);
      EXPECT_LT((m.spin - other.angular_velocity).norm(), 1e-12);
      EXPECT_LT((m.axes - other.orientation).norm(), 1e-13);
    }
  }
}

}  // namespace
}  // namespace softpoint::figure
