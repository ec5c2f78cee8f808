#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "play_fixture.h"
#include "sibling.h"

namespace softpoint::scene {
namespace {

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
