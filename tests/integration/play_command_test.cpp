#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "sibling.h"
#include "softpoint/picture/png.h"
#include "support/temporary_folder.h"

namespace softpoint::scene {
namespace {

class Play : public ::testing::Test {
 protected:
  std::filesystem::path in_folder(const std::string& name) const { return folder_.path() / name; }

  std::string text(const std::string& name) const {
    std::ifstream in(in_folder(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  int play(const std::string& arguments) const {
    const std::string scene = std::string(SOFTPOINT_EXAMPLES_FOLDER) + "/scenes/falling_box.json";
    return run("play " + scene + " " + arguments);
  }

  int run(const std::string& arguments) const {
    const std::string command =
        "cd " + folder_.path().string() + " && " + SOFTPOINT_PROGRAM + " " + arguments + " >stdout 2>stderr";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  TemporaryFolder folder_;
};

TEST_F(Play, LeavesPicturesOfTheSizeAskedFor) {
  ASSERT_EQ(play("--frames 2 --size 80x48 --out pictures"), 0) << text("stderr");
  const picture::Image image = picture::read_png(in_folder("pictures/frame_000000.png").string());
  EXPECT_EQ(image.width, 80);
  EXPECT_EQ(image.height, 48);
  EXPECT_TRUE(std::filesystem::exists(in_folder("pictures/sheet.png")));
  EXPECT_EQ(text("stderr"), "");
}

TEST_F(Play, WritesMeasurementsAndTraceWithoutPictures) {
  ASSERT_EQ(play("--frames 20 --no-pictures --metrics m.json --trace t.csv"), 0) << text("stderr");
  const auto metrics = nlohmann::json::parse(text("m.json"));
  EXPECT_EQ(metrics["frames"].get<int>(), 20);
  EXPECT_EQ(metrics["guard_fired"].get<int>(), 0);
  EXPECT_EQ(metrics["precision"].get<std::string>(),
            kBuiltPrecision == Precision::kDouble ? "double" : "single");
  const std::string trace = text("t.csv");
  EXPECT_EQ(std::count(trace.begin(), trace.end(), '\n'), 22);  // header, start, 20 frames
  EXPECT_EQ(trace.rfind("time,kinetic,", 0), 0u);
  EXPECT_FALSE(std::filesystem::exists(in_folder("out")));
}

TEST_F(Play, TheOtherPrecisionIsTheSiblingsWork) {
  const bool is_double = kBuiltPrecision == Precision::kDouble;
  const Precision other = is_double ? Precision::kSingle : Precision::kDouble;
  const auto program =
      std::filesystem::path(SOFTPOINT_PROGRAM).parent_path() / sibling_path(other).filename();
  const int code = play(std::string("--frames 1 --no-pictures --metrics m.json --precision ") +
                        (is_double ? "single" : "double"));
  if (std::filesystem::exists(program)) {
    ASSERT_EQ(code, 0) << text("stderr");
    EXPECT_EQ(nlohmann::json::parse(text("m.json"))["precision"].get<std::string>(),
              is_double ? "single" : "double");
  } else {
    EXPECT_EQ(code, 1);
  }
}

TEST_F(Play, RefusesBadInputInOneLine) {
  std::ofstream(in_folder("bad.json")) << R"({"frames": 2, "worldd": {}})";
  EXPECT_EQ(run("play bad.json --no-pictures"), 1);
  EXPECT_NE(text("stderr").find("bad.json: /worldd"), std::string::npos) << text("stderr");
  const std::string error = text("stderr");
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1);
  EXPECT_EQ(run("play none.json"), 1);
  EXPECT_EQ(play("--no-pictures --frames 1 --metrics no/such/m.json"), 1);
  EXPECT_EQ(play("--frames 1 --out stdout"), 1);  // a file stands there
}

TEST_F(Play, ACameraFollowsABodyOrItsKeyframes) {
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

TEST_F(Play, UsageErrorsHaveExitCodeTwo) {
  for (const char* arguments :
       {"--frames 0", "--size 80", "--size 8x8", "--size 80x80x80", "--precision half", "--x"}) {
    EXPECT_EQ(play(arguments), 2) << arguments;
  }
  EXPECT_EQ(run("play"), 2);
}

}  // namespace
}  // namespace softpoint::scene
