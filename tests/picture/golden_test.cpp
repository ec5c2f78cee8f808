#include "support/golden_image.h"

#include "scenes.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

#if !defined(PICTURE_GOLDEN_FOLDER) || !defined(PICTURE_OUTPUT_FOLDER)
#error "the build names the folder of the stored pictures and that for what differs from them"
#endif

constexpr const char* kListedDriver = "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6";

class Golden : public ::testing::TestWithParam<const char*> {
 protected:
  static const PictureScene& scene(std::string_view name) {
    const std::vector<PictureScene>& scenes = picture_scenes();
    return *std::find_if(scenes.begin(), scenes.end(), [&](const PictureScene& s) { return s.name == name; });
  }
};

TEST_P(Golden, PictureIsTheStoredOne) {
  const PictureScene& wanted = scene(GetParam());
  Renderer renderer(wanted.settings);
  const Image image = render(wanted, renderer);
  const GoldenImages golden{PICTURE_GOLDEN_FOLDER,
                            std::filesystem::path(PICTURE_OUTPUT_FOLDER) / backend_name(renderer.backend())};
  EXPECT_TRUE(golden.matches(wanted.name, image, renderer.driver()));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Golden,
                         ::testing::Values("small_scene", "shadow", "edges", "lines", "world"),
                         [](const auto& one) { return std::string(one.param); });

// The comparison itself.
class GoldenComparison : public Golden {
 protected:
  Image stored() const { return read_png(PICTURE_GOLDEN_FOLDER "/" + std::string(GetParam()) + ".png"); }
  std::string verdict(const Image& image, const char* driver) const {
    const ::testing::AssertionResult result = golden_.matches(GetParam(), image, driver);
    return result ? "" : result.message();
  }
  bool left(const std::string& suffix) const {
    return std::filesystem::exists(golden_.output / (std::string(GetParam()) + suffix));
  }

  TemporaryFolder folder_;
  GoldenImages golden_{.stored = PICTURE_GOLDEN_FOLDER, .output = folder_.file("output"), .refresh = false};
};

Image moved_right(const Image& image, int pixels) {
  Image moved = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::copy_n(image.pixel(std::max(x - pixels, 0), y), 4, moved.pixel(x, y));
    }
  }
  return moved;
}

TEST_P(GoldenComparison, PassesTheStoredPicture) {
  EXPECT_EQ(verdict(stored(), kListedDriver), "");
  EXPECT_EQ(verdict(stored(), "another driver"), "");
  EXPECT_FALSE(std::filesystem::exists(golden_.output)) << "nothing is left of a match";
}

TEST_P(GoldenComparison, FailsAPictureMovedByOnePixel) {
  for (const char* driver : {kListedDriver, "another driver"}) {
    std::filesystem::remove_all(golden_.output);
    const std::string message = verdict(moved_right(stored(), 1), driver);
    EXPECT_TRUE(mentions(message, ".actual.png")) << message;
    EXPECT_TRUE(mentions(message, ".difference.png")) << message;
    EXPECT_TRUE(left(".actual.png"));
    EXPECT_TRUE(left(".difference.png"));
  }
}

TEST_P(GoldenComparison, OneStepOfOneColourIsForOtherDriversOnly) {
  Image image = stored();
  image.rgba[4 * 1000] ^= 1;
  EXPECT_TRUE(mentions(verdict(image, kListedDriver), "dB"));
  EXPECT_EQ(verdict(image, "another driver"), "");
}

TEST_P(GoldenComparison, FailsAnotherSize) {
  const Image image = stored();
  const std::string message = verdict(shrink(image, image.width, image.height - 1), kListedDriver);
  EXPECT_TRUE(mentions(message, "stored is 1")) << message;
  EXPECT_TRUE(left(".actual.png"));
  EXPECT_FALSE(left(".difference.png"));
}

INSTANTIATE_TEST_SUITE_P(Scenes, GoldenComparison,
                         ::testing::Values("small_scene", "shadow", "edges", "lines", "world"),
                         [](const auto& one) { return std::string(one.param); });

TEST(GoldenStore, FailsAPictureNeverStored) {
  const TemporaryFolder folder;
  const GoldenImages golden{
      .stored = PICTURE_GOLDEN_FOLDER, .output = folder.file("output"), .refresh = false};
  const ::testing::AssertionResult result = golden.matches("no_such_picture", Image(32, 32), kListedDriver);
  EXPECT_FALSE(result);
  EXPECT_TRUE(mentions(result.message(), "there is no ")) << result.message();
}

TEST(GoldenStore, RefreshStoresAndFails) {
  const TemporaryFolder folder;
  GoldenImages golden{.stored = folder.file("stored"), .output = folder.file("output"), .refresh = true};
  const Image first(32, 32, {1, 0, 0}), second(32, 32, {0, 1, 0});
  EXPECT_FALSE(golden.matches("one", second, kListedDriver));
  EXPECT_FALSE(golden.matches("one", first, kListedDriver));
  EXPECT_FALSE(golden.matches("two", second, "some hardware"));
  golden.refresh = false;
  EXPECT_TRUE(golden.matches("one", first, kListedDriver));
  EXPECT_FALSE(golden.matches("one", second, kListedDriver));
  EXPECT_TRUE(golden.matches("two", second, "some hardware"));
  Image nearly = second;
  nearly.rgba[0] ^= 1;
  EXPECT_TRUE(golden.matches("two", nearly, "some hardware")) << "no hash of hardware is kept";
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
