#include <gtest/gtest.h>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_animation.h"
#include "support.h"

namespace softpoint::figure {
namespace {

FigureModel one_rod() {
  Link link;
  link.name = "rod";
  link.joint = JointKind::kFree;
  set_cylinder(link, 3, 0.1, 0.8);
  return FigureModel({link});
}

JointTrack base_at(const Vec3& place, const Vec3& turn, const Vec3& velocity, const Vec3& spin) {
  const double angle = turn.norm();
  const Eigen::Quaterniond q(Eigen::AngleAxisd(angle, angle > 0 ? Vec3(turn / angle) : Vec3(Vec3::UnitX())));
  // Two keys, so that there is a rate at the first.
  JointTrack track{0, Interpolation::kCubic, {}};
  for (const double t : {0.0, 1.0}) {
    track.keys.push_back({t,
                          {place.x(), place.y(), place.z(), q.w(), q.x(), q.y(), q.z()},
                          {spin.x(), spin.y(), spin.z(), velocity.x(), velocity.y(), velocity.z()}});
  }
  return track;
}

struct Watch {
  double deepest = 1, balance = 0, angular = 0;
};

// The deepest capsule of all frames, and how far momentum and its moment are off the books of gravity and
// impulses at the end.
Watch watch(FigureAnimation& animation) {
  animation.evaluate();
  const FigureModel& model = animation.model();
  const FigureClip& clip = animation.clip();
  FigureCollision collision(model, clip.capsules, clip.obstacles);
  FigureDynamics placer(model);
  Watch seen;
  Vec3 first = Vec3::Zero(), first_moment = Vec3::Zero();
  FigureMechanics sums;
  for (int k = 0; k < animation.frame_count(); ++k) {
    placer.place(animation.frame(k).q.data(), animation.frame(k).qd.data());
    collision.place(placer);
    for (const Touch& t : collision.near(1)) seen.deepest = std::min(seen.deepest, t.gap);
    sums = placer.mechanics();
    if (k > 0) continue;
    first = sums.momentum;
    first_moment = sums.angular_momentum;
  }
  const double time = (animation.frame_count() - 1) * animation.settings().frame_time;
  const Vec3 pull = model.total_mass() * time * animation.settings().gravity;
  seen.balance = (sums.momentum - first - pull - animation.counts().impulse).norm() / (1 + pull.norm());
  // Gravity's moment, once it pulls along z only, leaves what is upright alone.
  seen.angular =
      std::abs(sums.angular_momentum.z() - first_moment.z() - animation.counts().impulse_moment.z()) /
      (1 + first_moment.norm());
  return seen;
}

FigureClip falling(const Vec3& place, const Vec3& turn, const Vec3& velocity, const Vec3& spin) {
  FigureClip clip;
  clip.end = 2;
  clip.tracks = {base_at(place, turn, velocity, spin)};
  clip.capsules = {{0, {0, 0, 0}, {0, 0, 0.8}, 0.1}};
  clip.obstacles = {half_space({0, 0, 0}, Vec3::UnitZ())};
  clip.places = {{0, 2, PlaceRule::kContact, 0, {0, 0, 0}}};
  return clip;
}

TEST(LandingRule, DroppedFromTenMetresItNeverGoesInAndItsMomentumIsOnTheBooks) {
  const FigureModel model = one_rod();
  RandomFigures random(4);
  Watch worst;
  for (int trial = 0; trial < 10; ++trial) {
    const Vec3 spin = trial == 0 ? Vec3(Vec3::Zero()) : Vec3(3 * random.vector());
    FigureAnimation animation(model, falling({0, 0, 10}, random.vector(), random.vector(), spin));
    const Watch seen = watch(animation);
    worst.deepest = std::min(worst.deepest, seen.deepest);
    worst.balance = std::max(worst.balance, seen.balance);
    worst.angular = std::max(worst.angular, seen.angular);
    EXPECT_EQ(animation.counts().guard_fired, 0);
    EXPECT_GT(animation.counts().impulse.z(), 3 * 13);  // it did land
    ASSERT_FALSE(animation.events().empty());
    EXPECT_EQ(animation.events()[0].kind, PlaceEvent::Kind::kTakeOff);
  }
  std::printf("    deepest %.1e m, momentum off by %.1e, angular by %.1e\n", -worst.deepest, worst.balance,
              worst.angular);
  EXPECT_GT(worst.deepest, -1e-4);
  EXPECT_LT(worst.balance, 1e-9);
  EXPECT_LT(worst.angular, 1e-9);
}

TEST(LandingRule, NeverTunnelsAPlateOfACentimetre) {
  const FigureModel model = one_rod();
  RandomFigures random(6);
  Obstacle plate;
  plate.kind = Obstacle::Kind::kBox;
  plate.size = {20, 20, 0.01};
  for (int trial = 0; trial < 10; ++trial) {
    FigureClip clip =
        falling({0, 0, 2 + random.coin() * 0.37}, random.vector(), {0, 0, -50}, random.vector());
    clip.end = 0.2;
    clip.places[0].end = 0.2;
    clip.obstacles = {plate};
    FigureAnimation animation(model, clip);
    const Watch seen = watch(animation);
    EXPECT_GT(seen.deepest, -1e-4);
    for (int k = 0; k < animation.frame_count(); ++k) EXPECT_GT(animation.frame(k).q[2], -0.8);
    EXPECT_GT(animation.frame(animation.frame_count() - 1).q[2], 0);
    EXPECT_GT(animation.counts().impulse.z(), 3 * 45);
  }
}

TEST(LandingRule, RestsWithoutSinkingOrSliding) {
  const FigureModel model = one_rod();
  FigureClip clip = falling({0, 0, 0.1}, {0, M_PI / 2, 0}, {0, 0, 0}, {0, 0, 0});
  FigureAnimation animation(model, clip);
  animation.evaluate();
  for (int k = 0; k < animation.frame_count(); ++k) {
    EXPECT_NEAR(animation.frame(k).q[2], 0.1, 3e-5);
    EXPECT_NEAR(animation.frame(k).q[0], 0, 1e-6);
  }
  // On a slope: it slides where friction is less than the slope's tangent.
  clip.obstacles = {half_space({0, 0, 0}, {0, 0.3, 1})};
  clip.tracks[0] = base_at({0, 0, 0.1 * std::sqrt(1.09)}, {0, M_PI / 2, 0}, {0, 0, 0}, {0, 0, 0});
  for (const double friction : {0.1, 0.0}) {
    AnimationSettings settings;
    settings.friction = friction;
    FigureAnimation slides(model, clip, settings);
    slides.evaluate();
    const double path = slides.frame(60).q[1];
    const double slope = std::atan(0.3), along = 9.81 * (std::sin(slope) - friction * std::cos(slope));
    if (friction == 0) {
      EXPECT_NEAR(path, 0.5 * along * 4 * std::cos(slope), 0.05);
    } else {
      EXPECT_GT(path, 0.3);  // it rolls with friction
    }
  }
}

// The humanoid, all joints limp, falls on a floor with a box on it.
TEST(LandingRule, ALimpHumanoidFallsInAHeap) {
  const FigureModel model = read_amdl_file(data_file("mjhum27.amdl"));
  FigureClip clip = falling({0, 0, 1.6}, {0.3, 0.2, 0.1}, {1, 0, 0}, {0, 0, 0});
  clip.capsules.clear();
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    if (link.mass > 0) clip.capsules.push_back({i, link.center_of_mass, link.center_of_mass, 0.06});
  }
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.size = {0.4, 2, 0.3};
  box.position = {0.6, 0, 0.15};
  clip.obstacles.push_back(box);
  DynamicInterval all{0, 2, {}};
  for (int i = 1; i < model.link_count(); ++i) {
    all.links.push_back(i);
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    clip.tracks.push_back({i, Interpolation::kCubic, {{0, {0.5 * (link.lower + link.upper)}, {}}}});
  }
  clip.dynamics = {all};
  FigureAnimation animation(model, clip);
  const Watch seen = watch(animation);
  std::printf("    deepest %.1e m, momentum off by %.1e, angular by %.1e\n", -seen.deepest, seen.balance,
              seen.angular);
  EXPECT_GT(seen.deepest, -1e-4);
  EXPECT_LT(seen.balance, 1e-9);
  EXPECT_LT(seen.angular, 1e-9);
  EXPECT_EQ(animation.counts().guard_fired, 0);
  EXPECT_LT(animation.frame(60).q[2], 0.8);
  for (int i = 1; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    const double q = animation.frame(60).q[static_cast<std::size_t>(model.position_offset(i))];
    EXPECT_GE(q, link.lower - 1e-10);
    EXPECT_LE(q, link.upper + 1e-10);
  }
}

}  // namespace
}  // namespace softpoint::figure
