#include <fstream>

#include "play_fixture.h"
#include "softpoint/picture/png.h"

namespace softpoint::scene {
namespace {

using PlayPictures = Play;

TEST_F(PlayPictures, LeavesPicturesOfTheSizeAskedFor) {
  ASSERT_EQ(play("--frames 2 --size 80x48 --out pictures"), 0) << text("stderr");
  const picture::Image image = picture::read_png(in_folder("pictures/frame_000000.png").string());
  EXPECT_EQ(image.width, 80);
  EXPECT_EQ(image.height, 48);
  EXPECT_TRUE(std::filesystem::exists(in_folder("pictures/sheet.png")));
  EXPECT_EQ(text("stderr"), "");
}

TEST_F(PlayPictures, AFileIsNoFolder) {
  EXPECT_EQ(play("--frames 1 --out stdout"), 1);  // a file stands there
  EXPECT_NE(text("stderr").find("stdout"), std::string::npos) << text("stderr");
}

TEST_F(PlayPictures, ACameraFollowsABodyOrItsKeyframes) {
  const auto picture_with = [&](const std::string& camera) {
    std::ofstream(in_folder("scene.json")) << R"({"rigid_bodies": [
      {"name": "box", "shape": "box", "size": [1, 1, 1], "mass": 1}], "frames": 60,
      "pictures": {"every": 60, "time": false, "sheet": false}, "camera": {"eye": [0, 0, 9], "target": [0, 0, 0])" +
                                                  camera + "}}";
    EXPECT_EQ(run("play scene.json --size 64x64 --out p"), 0) << text("stderr");
    return std::pair(picture::read_png(in_folder("p/frame_000000.png").string()),
                     picture::read_png(in_folder("p/frame_000060.png").string()));
  };
  const auto brown = [](const picture::Image& image) {  // of the box, against the pale background
    int count = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        count += image.pixel(x, y)[2] < 150;
      }
    }
    return count;
  };
  const auto fixed = picture_with("");
  EXPECT_LT(brown(fixed.second), brown(fixed.first));  // it falls out of sight
  const auto followed = picture_with(R"(, "follow": "box")");
  EXPECT_EQ(brown(followed.second), brown(followed.first));
  const auto led = picture_with(R"(, "keyframes": [{"time": 0, "eye": [0, 0, 9], "target": [0, 0, 0]},
    {"time": 1, "eye": [0, 0, 9], "target": [9, 0, 9]}])");
  EXPECT_EQ(brown(led.second), 0);  // looks away
}

}  // namespace
}  // namespace softpoint::scene
