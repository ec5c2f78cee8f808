// Biovision files: read, refused, written back; figures of skeletons, and motion of figures as a clip.
#include "softpoint/figure/bvh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <sstream>

#include "softpoint/core/error.h"
#include "softpoint/figure/amdl.h"
#include "softpoint/figure/figure_animation.h"
#include "softpoint/figure/figure_stepper.h"
#include "support.h"
#include "support/refusal.h"

namespace softpoint::figure {
namespace {

constexpr const char* kWalker = R"(HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT Left leg
  {
    OFFSET 1.5 -0.5 0
    CHANNELS 3 Zrotation Yrotation Xrotation
    End Site
    {
      OFFSET 0 -7 +0.5
    }
  }
  joint Chest
  {
    OFFSET 0 3 0
    CHANNELS 3 Xrotation Zrotation Yrotation
    JOINT Head { OFFSET 0 2.5 0 CHANNELS 0 End Site { OFFSET 0 1 0 } }
  }
}
MOTION
Frames: 2
Frame Time: .0333333
1 17 -2 10 20 30  5 0 0  0 0 90
1 17 -1 10 20 31  6 0 0  0 1e-400 91
)";

BvhClip walker() {
  std::istringstream in(kWalker);
  return read_bvh(in, "walker.bvh");
}

TEST(Bvh, ReadsSkeletonAndMotionAndWritesThemBack) {
  const BvhClip clip = walker();
  ASSERT_EQ(clip.joints.size(), 4u);
  EXPECT_EQ(clip.joints[1].name, "Left leg");
  EXPECT_EQ(clip.joints[2].parent, 0);
  EXPECT_EQ(clip.joints[3].parent, 2);
  EXPECT_EQ(clip.joints[1].end_sites.at(0), Vec3(0, -7, 0.5));
  EXPECT_EQ(clip.channel_count(), 12);
  EXPECT_EQ(clip.frame_count(), 2);
  EXPECT_EQ(clip.values[12 + 2], -1);
  std::istringstream again(bvh_text(clip));
  const BvhClip copy = read_bvh(again, "copy");
  ASSERT_EQ(copy.joints.size(), clip.joints.size());
  for (std::size_t i = 0; i < copy.joints.size(); ++i) {
    EXPECT_EQ(copy.joints[i].name, clip.joints[i].name);
    EXPECT_EQ(copy.joints[i].parent, clip.joints[i].parent);
    EXPECT_EQ(copy.joints[i].offset, clip.joints[i].offset);
    EXPECT_EQ(copy.joints[i].channels, clip.joints[i].channels);
    EXPECT_EQ(copy.joints[i].end_sites, clip.joints[i].end_sites);
  }
  EXPECT_EQ(copy.values, clip.values);
  EXPECT_EQ(copy.frame_time, clip.frame_time);
}

TEST(Bvh, RefusesWithTheLine) {
  const auto refuse = [](std::string from, const std::string& to, const std::vector<std::string>& fragments) {
    std::string text = kWalker;
    if (from.empty()) {
      text = to;
    } else {
      text.replace(text.find(from), from.size(), to);
    }
    std::istringstream in(text);
    expect_refusal([&] { read_bvh(in, "walker.bvh"); }, fragments);
  };
  refuse("", "", {"walker.bvh line 1", "HIERARCHY"});
  refuse("ROOT", "JOINT", {"line 2: 'JOINT'; permitted is ROOT"});
  refuse("OFFSET 1.5", "OFFSET x", {"line 8", "'x'; permitted is a number"});
  refuse("OFFSET 1.5", "OFFSET nan", {"line 8", "permitted"});
  refuse("OFFSET 1.5", "OFFSET 1e999", {"line 8", "permitted"});
  refuse("CHANNELS 6", "CHANNELS 7", {"CHANNELS = 7", "0 to 6"});
  refuse("Xposition", "Wposition", {"line 5", "'Wposition'", "Xposition to Zrotation"});
  refuse("Yposition", "Xposition", {"'Xposition' twice"});
  refuse("Frames: 2", "Frames: 3", {"channel ''", "a number"});
  refuse("Frames: 2", "Frames: 1", {"after the last frame"});
  refuse("Frames: 2", "Frames: 99999999", {"channel ''", "a number"});
  refuse("Time: .0333333", "Time: 0", {"Frame Time = 0", "permitted"});
  refuse("MOTION", "ROOT Other { OFFSET 0 0 0 CHANNELS 0 } MOTION", {"a second ROOT"});
  std::string deep = "HIERARCHY ROOT a { OFFSET 0 0 0 CHANNELS 0 ";
  for (int i = 0; i < 300; ++i) deep += "JOINT b { OFFSET 0 0 1 CHANNELS 0 ";
  refuse("", deep, {"deeper than 256"});
}

// The pose of a joint from the file alone.
Eigen::Isometry3d bvh_pose(const BvhClip& clip, int joint, int frame) {
  const BvhJoint& j = clip.joints[static_cast<std::size_t>(joint)];
  std::size_t at = static_cast<std::size_t>(frame * clip.channel_count());
  for (int i = 0; i < joint; ++i) at += clip.joints[static_cast<std::size_t>(i)].channels.size();
  Eigen::Isometry3d own(Eigen::Translation3d(j.offset));
  for (std::size_t k = 0; k < j.channels.size(); ++k) {
    const int axis = static_cast<int>(j.channels[k]) % 3;
    const double value = clip.values[at + k];
    if (j.channels[k] < BvhChannel::kXRotation) {
      own.translate(Vec3(value * Vec3::Unit(axis)));
    } else {
      own.rotate(Eigen::AngleAxisd(value * std::numbers::pi / 180, Vec3::Unit(axis)));
    }
  }
  return j.parent < 0 ? own : bvh_pose(clip, j.parent, frame) * own;
}

double pose_difference(const BvhClip& clip, int joint, int frame, const LinkMotion& motion) {
  const Eigen::Isometry3d pose = bvh_pose(clip, joint, frame);
  return std::max((pose.translation() - motion.position).norm(), (pose.linear() - motion.orientation).norm());
}

TEST(Bvh, FiguresOfSkeletonsStandAsTheFileSays) {
  const BvhClip clip = walker();
  const FigureModel model = bvh_figure(clip);
  EXPECT_EQ(model.velocity_count(), 6 + 9);
  FigureDynamics dynamics(model);
  FigureState state = rest_state(model);
  for (int frame = 0; frame < 2; ++frame) {
    state.q = bvh_positions(clip, frame);
    dynamics.place(state.q.data(), state.qd.data());
    for (int i = 0; i < 4; ++i) EXPECT_LE(pose_difference(clip, i, frame, dynamics.motion(i)), 1e-12);
  }
  // A leg of 7.0178 m and its cylinder.
  const double length = std::hypot(7, 0.5), radius = 0.1 * length;
  EXPECT_NEAR(model.links()[1].mass, 1000 * std::numbers::pi * radius * radius * length, 1e-6);
  EXPECT_NEAR(bvh_figure(clip, {0.1, 500, 0.1}).links()[1].mass, 0.5e-3 * model.links()[1].mass, 1e-9);
  FigureStepper stepper(model, {bvh_positions(clip, 0), state.qd});
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(stepper.step(1.0 / 60));
  expect_refusal([&] { bvh_positions(clip, 2); }, {"bvh frame = 2"});
  expect_refusal([&] { bvh_figure(clip, {0, 1000, 0.1}); }, {"bvh scale = 0"});
}

// The clip's motion as keys passes through every frame, and its bones are shapes.
TEST(Bvh, MotionAsKeysAndBonesAsCapsules) {
  const BvhClip clip = walker();
  const BvhFigureSettings inches{0.0254, 1000, 0.15};
  const FigureModel model = bvh_figure(clip, inches);
  FigureClip keyed;
  keyed.tracks = bvh_tracks(clip, Interpolation::kCubic, inches);
  keyed.capsules = bvh_capsules(clip, inches);
  keyed.end = clip.frame_time;
  ASSERT_EQ(keyed.capsules.size(), 5u);
  EXPECT_EQ(keyed.capsules[3].link, 2);  // from chest to head
  EXPECT_LE((keyed.capsules[3].to - Vec3(0, 2.5 * 0.0254, 0)).norm(), 1e-15);
  AnimationSettings settings;
  settings.frame_time = clip.frame_time;
  FigureAnimation animation(model, keyed, settings);
  animation.evaluate();
  ASSERT_EQ(animation.frame_count(), 2);
  for (int frame = 0; frame < 2; ++frame) {
    const std::vector<double> q = bvh_positions(clip, frame, inches);
    for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(animation.frame(frame).q[k], q[k], 1e-12);
  }
  EXPECT_EQ(animation.counts().forward_calls, 0);
  BvhClip still = clip;
  still.values.clear();
  expect_refusal([&] { bvh_tracks(still, Interpolation::kCubic); }, {"bvh frames: none"});
}

TEST(Bvh, RecordsTheMotionOfAnyFigure) {
  RandomFigures random(41);
  double worst = 0;
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<Link> links = random.model(9, trial % 2 == 0).links();
    if (trial == 3) links[4].parent = -1;  // two stand on the world
    const FigureModel model(links);
    BvhRecorder recorder(model, 1.0 / 60);
    FigureStepper stepper(model, random.state(model));
    for (int frame = 0; frame < 30; ++frame) {
      recorder.add(stepper.state().q.data());
      std::istringstream in(bvh_text(recorder.clip()));
      const BvhClip clip = frame == 29 ? read_bvh(in, "recorded") : recorder.clip();
      ASSERT_EQ(clip.frame_count(), frame + 1);
      stepper.dynamics().place(stepper.state().q.data(), stepper.state().qd.data());
      for (int i = 0; i < 9; ++i) {
        worst =
            std::max(worst, pose_difference(clip, recorder.joint_of(i), frame, stepper.dynamics().motion(i)));
      }
      stepper.step(1.0 / 600);
    }
  }
  std::printf("    off by %.1e\n", worst);
  EXPECT_LE(worst, 1e-9);
}

// A turning joint's angle runs on, whole turns and all.
TEST(Bvh, RecordedAnglesDoNotJump) {
  const FigureModel model = read_amdl_file(data_file("pend2.amdl"));
  BvhRecorder recorder(model, 0.01);
  for (int i = 0; i < 500; ++i) {
    const double q[] = {0.05 * i, -0.03 * i};
    recorder.add(q);
  }
  const BvhClip& clip = recorder.clip();
  const int n = clip.channel_count();
  for (int i = 1; i < clip.frame_count(); ++i) {
    for (int k = 0; k < n; ++k) {
      EXPECT_LE(std::abs(clip.values[static_cast<std::size_t>(i * n + k)] -
                         clip.values[static_cast<std::size_t>((i - 1) * n + k)]),
                5);
    }
  }
}

}  // namespace
}  // namespace softpoint::figure
