#include <gtest/gtest.h>

#include "link_chain.h"
#include "softpoint/figure/figure_animation.h"

namespace softpoint::figure {
namespace {

// A trunk on one leg of two sliding joints: the foot's sole and the leg's length.
struct Hopper {
  Hopper() : model(links()) {
    clip.end = 2;
    clip.capsules = {{1, {0, 0, 0}, {0, 0, 0}, 0.1}, {0, {0, 0, 0}, {0, 0, 0.5}, 0.1}};
    clip.obstacles = {half_space({0, 0, 0}, Vec3::UnitZ())};
    clip.places = {{0, 2, PlaceRule::kGravity, 1, {0, 0, 0}}};
    clip.tracks = {{0, Interpolation::kCubic, {{0, {0, 0, 0.5, 1, 0, 0, 0}, {}}}},
                   leg({{0, 0.4}, {0.25, 0.8}, {1, 0.6}})};
  }
  static std::vector<Link> links() {
    Link trunk, foot;
    trunk.name = "trunk";
    trunk.joint = JointKind::kFree;
    trunk.mass = 50;
    trunk.inertia = Mat3::Identity();
    foot.name = "foot";
    foot.parent = 0;
    foot.joint = JointKind::kPrismatic;
    foot.axis = -Vec3::UnitZ();
    foot.mass = 2;
    foot.inertia = 0.01 * Mat3::Identity();
    return {trunk, foot};
  }
  static JointTrack leg(std::vector<std::pair<double, double>> lengths) {
    JointTrack track{1, Interpolation::kCubic, {}};
    for (const auto& [time, length] : lengths) track.keys.push_back({time, {length}, {0}});
    return track;
  }
  double height(const FigureAnimation& animation, int frame) const {
    const std::vector<double>& q = animation.frame(frame).q;
    return (50 * q[2] + 2 * (q[2] - q[7])) / 52;
  }

  FigureModel model;
  FigureClip clip;
};

TEST(GravityRule, JumpsWhereTheLegSlowsFasterThanGravityAndLandsTouching) {
  Hopper hopper;
  FigureAnimation animation(hopper.model, hopper.clip);
  animation.evaluate();
  ASSERT_EQ(animation.events().size(), 2u);
  const PlaceEvent off = animation.events()[0], on = animation.events()[1];
  EXPECT_EQ(off.kind, PlaceEvent::Kind::kTakeOff);
  EXPECT_EQ(on.kind, PlaceEvent::Kind::kLanding);
  EXPECT_GT(off.time, 0.125);  // not while the leg gains speed
  EXPECT_LT(off.time, 0.25);
  // In flight the centre of mass goes by gravity alone, as (5) and (6) have it.
  const int first = static_cast<int>(std::lround(30 * off.time)),
            last = static_cast<int>(std::lround(30 * on.time));
  ASSERT_GT(last - first, 4);
  for (int k = first; k + 2 < last; ++k) {
    const double bend =
        hopper.height(animation, k + 2) - 2 * hopper.height(animation, k + 1) + hopper.height(animation, k);
    EXPECT_NEAR(bend * 900, -9.81, 1e-8);
  }
  // Feet: on the floor before and after, above it in between.
  for (int k = 0; k < animation.frame_count(); ++k) {
    const std::vector<double>& q = animation.frame(k).q;
    const double sole = q[2] - q[7] - 0.1;
    if (k < first || k >= last) {
      EXPECT_NEAR(sole, 0, 1e-9) << k;
    } else {
      EXPECT_GT(sole, 1e-3) << k;
    }
  }
  EXPECT_GT(animation.counts().narrow_tests, 0);
  EXPECT_EQ(animation.counts().narrow_tests, animation.counts().boxes_overlapping);
}

TEST(GravityRule, HoldsTheLinkThatTouchedFirst) {
  Hopper hopper;
  hopper.clip.places[0].link = -1;
  hopper.clip.tracks[0].keys[0].q = {0, 0, 1.5, 0,
                                     1, 0, 0};  // upside down: the trunk's end falls on the floor
  FigureAnimation animation(hopper.model, hopper.clip);
  animation.evaluate();
  ASSERT_EQ(animation.events().size(), 1u);
  EXPECT_EQ(animation.events()[0].kind, PlaceEvent::Kind::kLanding);
  EXPECT_EQ(animation.events()[0].link, 0);
  EXPECT_NEAR(animation.frame(60).q[2], 0.6, 1e-9);
}

TEST(GravityRule, FeltByDynamicJointsInFlight) {
  // A pendulum on a falling trunk does not swing.
  std::vector<Link> links = Hopper::links();
  links[1].joint = JointKind::kHinge;
  links[1].axis = Vec3::UnitX();
  links[1].center_of_mass = {0, 0, -0.3};
  const FigureModel model(links);
  FigureClip clip;
  clip.end = 0.5;
  clip.capsules = {{0, {0, 0, 0}, {0, 0, 0.5}, 0.1}};
  clip.obstacles = {half_space({0, 0, -50}, Vec3::UnitZ())};
  clip.places = {{0, 0.5, PlaceRule::kGravity, 0, {0, 0, 0}}};
  clip.tracks = {{1, Interpolation::kCubic, {{0, {0.8}, {}}}}};
  clip.dynamics = {{0, 0.5, {1}}};
  FigureAnimation animation(model, clip);
  animation.evaluate();
  EXPECT_NEAR(animation.frame(15).q[7], 0.8, 1e-9);
  clip.places = {{0, 0.5, PlaceRule::kPin, 0, {0, 0, 0}}};
  FigureAnimation hung(model, clip);
  hung.evaluate();
  EXPECT_LT(hung.frame(15).q[7], 0.4);
}

}  // namespace
}  // namespace softpoint::figure
