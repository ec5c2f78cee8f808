#include "play_fixture.h"

namespace softpoint::scene {
namespace {

using PlayWithoutPictures = Play;

// The program of a build that has no picture plugin.
TEST_F(PlayWithoutPictures, SaysSoAndPlaysOn) {
  ASSERT_EQ(play("--frames 2 --video --out pictures --metrics m.json"), 0) << text("stderr");
  EXPECT_EQ(text("stderr"), "no pictures, no film: this program was built without the picture plugin\n");
  EXPECT_TRUE(std::filesystem::exists(in_folder("m.json")));
  EXPECT_FALSE(std::filesystem::exists(in_folder("pictures")));
}

}  // namespace
}  // namespace softpoint::scene
