#include "softpoint/picture/text.h"

#include <set>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TextStyle bare(double scale = 1) {
  TextStyle style;
  style.color = {0, 0, 0};
  style.scale = scale;
  style.backing.a = 0;
  return style;
}

Image written(std::string_view text, double scale = 1) {
  const TextSize size = measure_text(text, bare(scale));
  Image image(size.width, size.height, {1, 1, 1});
  draw_text(image, 0, 0, text, bare(scale));
  return image;
}

TEST(Text, EveryCharacterHasAFaceOfItsOwn) {
  std::set<std::uint64_t> faces;
  for (char c = 32; c < 127; ++c) {
    const Image image = written(std::string(1, c), 2);
    EXPECT_EQ(count_drawn(image) > 0, c != ' ') << c;
    EXPECT_TRUE(faces.insert(hash(image)).second) << c << " looks like another";
  }
  EXPECT_EQ(written("\x80", 2), written("?", 2));
}

TEST(Text, StaysWithinItsMeasure) {
  // Nothing of the ink touches the border of the plate, so none was cut off.
  for (const double scale : {0.5, 1.0, 1.7, 3.0}) {
    const Image image = written("Wgj|_\n@Qy[]", scale);
    for (int x = 0; x < image.width; ++x) {
      EXPECT_TRUE(is_white(image.pixel(x, 0)));
      EXPECT_TRUE(is_white(image.pixel(x, image.height - 1)));
    }
    for (int y = 0; y < image.height; ++y) {
      EXPECT_TRUE(is_white(image.pixel(0, y)));
      EXPECT_TRUE(is_white(image.pixel(image.width - 1, y)));
    }
  }
}

TEST(Text, InkGrowsWithTheSquareOfTheScale) {
  const auto ink = [](double scale) {
    const Image image = written("Elastic 0.25", scale);
    double sum = 0;
    for (std::size_t i = 0; i < image.rgba.size(); i += 4) sum += 255 - image.rgba[i];
    return sum;
  };
  EXPECT_NEAR(ink(4) / ink(2), 4, 0.3);
}

TEST(Text, IsTranslatedByWholePixels) {
  Image a(200, 60, {1, 1, 1}), b(200, 60, {1, 1, 1});
  draw_text(a, 5, 6, "abc\nd", bare());
  draw_text(b, 25, 16, "abc\nd", bare());
  for (int y = 0; y < 50; ++y) {
    for (int x = 0; x < 180; ++x) EXPECT_EQ(a.pixel(x, y)[0], b.pixel(x + 20, y + 10)[0]);
  }
}

TEST(Text, IsClippedAtTheBorders) {
  Image image(40, 30, {1, 1, 1});
  TextStyle style;
  draw_text(image, -20, -10, "clipped", style);
  draw_text(image, 30, 25, "clipped", style);
  draw_text(image, 1000, -1000, "clipped", style);
  EXPECT_GT(count_drawn(image), 0);
}

TEST(Text, BackingBlendsByItsOpacity) {
  Image image(100, 40, {0, 0, 0});
  TextStyle style;
  style.backing = {1, 1, 1, 0.5F};
  draw_text(image, 10, 10, " ", style);
  EXPECT_NEAR(image.pixel(12, 12)[0], 128, 1);
  EXPECT_EQ(image.pixel(5, 5)[0], 0);
}

TEST(Text, RefusesScalesByName) {
  TextStyle style;
  style.scale = 17;
  EXPECT_TRUE(mentions(refusal([&] { measure_text("a", style); }), "text scale = 17"));
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
