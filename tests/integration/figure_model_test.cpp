// Figures of scenes from files: a skeleton with its motion, a limb of it left to dynamics, written back.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "figure_motion_files.h"
#include "player.h"
#include "scene_reader.h"
#include "softpoint/figure/urdf.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace softpoint::scene {
namespace {

// A body with two arms that swing, in hundredths of a metre; three frames.
constexpr const char* kSwinger = R"(HIERARCHY
ROOT Body
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Left { OFFSET 20 40 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 60 0 0 } }
  JOINT Right { OFFSET -20 40 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET -60 0 0 } }
  End Site { OFFSET 0 60 0 }
}
MOTION
Frames: 4
Frame Time: 0.5
0 100 0  0 0 0   0 0 0    0 0 0
0 110 0  0 0 0   30 0 0  -30 0 0
0 120 0  0 90 0  60 0 0  -60 0 0
0 100 0  0 0 0   0 0 0    0 0 0
)";

class FigureFromFile : public testing::Test {
 protected:
  Scene scene(const std::string& figure) {
    write("swinger.bvh", kSwinger);
    write("scene.json", R"({"world": {"time_step": 0.05}, "frames": 30, "figures": [{"name": "swinger", )" +
                            figure + "}]}");
    return read_scene(folder_.path() / "scene.json");
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
  }
  void expect_refused(const std::string& figure, const std::vector<std::string>& fragments) {
    expect_refusal([&] { scene(figure); }, fragments);
  }

  TemporaryFolder folder_;
};

TEST_F(FigureFromFile, MotionOfASkeletonIsPlayedAndWrittenBack) {
  Player player(scene(R"("model": {"file": "swinger.bvh", "scale": 0.01, "position": [1, 0, 2]})"));
  const FigureActor& actor = player.figure(0);
  EXPECT_NEAR(actor.animation().clip().end, 1.5, 1e-12);
  EXPECT_EQ(actor.controller().body_count(), 5);
  FigureMotionFiles files(player, folder_.path() / "motion");
  while (player.frame() < player.scene().frames) {
    player.step();
    files.record();
  }
  const std::vector<std::string> written = files.write();
  ASSERT_EQ(written.size(), 1U);
  EXPECT_EQ(std::filesystem::path(written[0]).filename(), "swinger.bvh");
  const figure::BvhClip clip = figure::read_bvh_file(written[0]);
  EXPECT_EQ(clip.frame_count(), 31);
  EXPECT_NEAR(clip.frame_time, 0.05, 1e-15);
  const auto value = [&](int frame, int channel) {
    return clip.values[static_cast<std::size_t>(frame * clip.channel_count() + channel)];
  };
  for (int key = 0; key < 4; ++key) {
    const double height[] = {1, 1.1, 1.2, 1}, left[] = {0, 30, 60, 0};
    EXPECT_NEAR(value(10 * key, 0), 1, 1e-9);
    EXPECT_NEAR(value(10 * key, 1), height[key], by_precision(1e-9, 1e-6)) << key;
    EXPECT_NEAR(value(10 * key, 2), 2, 1e-9);
    // The world's time is a number of Bullet's.
    EXPECT_NEAR(value(10 * key, 6), left[key], by_precision(1e-9, 1e-4)) << key;
  }
}

TEST_F(FigureFromFile, ALimbOfItIsLeftToDynamicsAndKeysOverruleTheFile) {
  Player player(scene(
      R"("model": {"file": "swinger.bvh", "scale": 0.01, "up": "z"}, "dynamic": [{"begin": 0.5, "end": 1.4, "limb": "Left"}],
         "key_times": [0, 1], "joints": [{"joint": "Right", "values": [0, 0, 0, 0, 0, 1]}], "end": 1.5)"));
  const figure::FigureAnimation& animation = player.figure(0).animation();
  EXPECT_GT(animation.counts().dynamic_steps, 20);
  EXPECT_EQ(animation.counts().guard_fired, 0);
  const figure::FigureModel& model = animation.model();
  const figure::FigureState& end = animation.frame(animation.frame_count() - 1);
  // Its y axis is the scene's z: the body stands 1 m up along it, turned by a quarter about x.
  EXPECT_NEAR(animation.frame(0).q[2], 1, 1e-12);
  EXPECT_NEAR(animation.frame(0).q[4], std::sqrt(0.5), 1e-12);
  const int right = model.position_offset(model.find("Right"));
  EXPECT_NEAR(
      2 * std::atan2(end.q[static_cast<std::size_t>(right + 3)], end.q[static_cast<std::size_t>(right)]), 1,
      1e-9);
}

TEST_F(FigureFromFile, ARobotBringsItsShapes) {
  if (!figure::has_urdf()) GTEST_SKIP() << "built without liburdfdom";
  write("robot.urdf",
        "<robot name='r'><link name='stand'/><link name='arm'><inertial><origin xyz='0 0 0.5'/><mass "
        "value='1'/>"
        "<inertia ixx='0.1' iyy='0.1' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial><collision><origin "
        "xyz='0 0 "
        "0.5'/><geometry><capsule radius='0.1' length='1'/></geometry></collision></link><joint "
        "name='shoulder' "
        "type='spherical'><parent link='stand'/><child link='arm'/></joint></robot>");
  const FigureSpec spec =
      scene(
          R"("model": {"file": "robot.urdf"}, "dynamic": [{"begin": 0, "end": 1, "limb": "arm"}], "end": 1)")
          .figures.at(0);
  ASSERT_EQ(spec.clip.capsules.size(), 1U);
  EXPECT_EQ(spec.clip.capsules[0].to, Vec3(0, 0, 1));
  EXPECT_EQ(spec.model->links()[1].joint, figure::JointKind::kBall);
}

TEST_F(FigureFromFile, WhatDoesNotFitIsRefused) {
  expect_refused(R"("end": 1)", {"/figures/0/links", "1 to 1000", "model"});
  expect_refused(R"("model": {"file": "none.bvh"})", {"/figures/0/model/file", "none.bvh cannot be read"});
  expect_refused(R"("model": {"file": "scene.json"})", {"/figures/0/model/file", "scene.json"});
  expect_refused(R"("model": {"file": "swinger.bvh", "scale": 0})", {"/figures/0/model/scale = 0"});
  expect_refused(R"("model": {"file": "swinger.bvh"}, "links": [{"name": "a", "tip": [0, 1, 0], "mass": 1}])",
                 {"/figures/0/links", "beside a model"});
  expect_refused(R"("model": {"file": "swinger.bvh"}, "joints": [{"joint": "Tail", "values": [0]}])",
                 {"Tail", "permitted"});
}

}  // namespace
}  // namespace softpoint::scene
