#include "softpoint/picture/image.h"

#include "softpoint/picture/material.h"
#include "srgb.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(Image, FillsWithItsColour) {
  const Image image(3, 2, {1, 0.5F, 0, 1});
  EXPECT_EQ(image.rgba.size(), 24U);
  const std::uint8_t* p = image.pixel(2, 1);
  EXPECT_EQ(p[0], 255);
  EXPECT_EQ(p[1], 128);
  EXPECT_EQ(p[2], 0);
  EXPECT_EQ(p[3], 255);
  EXPECT_TRUE(mentions(refusal([] { Image(0, 5); }), "image width = 0"));
}

TEST(Shrink, AveragesRectangles) {
  Image image(4, 2);
  const int values[] = {10, 20, 100, 200, 30, 40, 0, 100};
  for (int i = 0; i < 8; ++i)
    image.rgba[static_cast<std::size_t>(4 * i)] = static_cast<std::uint8_t>(values[i]);
  const Image half = shrink(image, 2, 1);
  EXPECT_EQ(half.pixel(0, 0)[0], 25);
  EXPECT_EQ(half.pixel(1, 0)[0], 100);
}

TEST(Shrink, WeighsPartlyCoveredPixels) {
  Image image(3, 1);
  const int values[] = {0, 90, 240};
  for (int i = 0; i < 3; ++i)
    image.rgba[static_cast<std::size_t>(4 * i)] = static_cast<std::uint8_t>(values[i]);
  const Image two = shrink(image, 2, 1);
  EXPECT_EQ(two.pixel(0, 0)[0], 30);   // (0 + 90/2) / 1.5
  EXPECT_EQ(two.pixel(1, 0)[0], 190);  // (90/2 + 240) / 1.5
}

TEST(Shrink, KeepsTheMeanAndTheFullSize) {
  Image image(37, 23);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = static_cast<std::uint8_t>(i * 2654435761U >> 7);
  EXPECT_EQ(shrink(image, 37, 23), image);
  const auto mean = [](const Image& im) {
    double sum = 0;
    for (const std::uint8_t byte : im.rgba) sum += byte;
    return sum / static_cast<double>(im.rgba.size());
  };
  EXPECT_NEAR(mean(shrink(image, 10, 7)), mean(image), 0.5);
  EXPECT_TRUE(mentions(refusal([&] { shrink(image, 38, 5); }), "shrink width = 38"));
}

TEST(Psnr, FollowsItsDefinition) {
  const Image a(8, 8, {0.5F, 0.5F, 0.5F});
  Image b = a;
  EXPECT_TRUE(std::isinf(psnr(a, b)));
  for (std::size_t i = 0; i < b.rgba.size(); ++i)
    b.rgba[i] = static_cast<std::uint8_t>(b.rgba[i] - (i % 4 < 3 ? 5 : 0));
  EXPECT_NEAR(psnr(a, b), 20 * std::log10(255.0 / 5), 1e-9);
  EXPECT_TRUE(mentions(refusal([&] { psnr(a, Image(8, 9)); }), "8x8 and 8x9"));
}

TEST(Hash, TellsPicturesApart) {
  const Image a(4, 6);
  Image b = a;
  EXPECT_EQ(hash(a), hash(b));
  b.rgba[17] ^= 1;
  EXPECT_NE(hash(a), hash(b));
  EXPECT_NE(hash(a), hash(Image(6, 4)));
}

TEST(Palette, NeighboursDiffer) {
  const auto distance = [](Color a, Color b) { return std::hypot(a.r - b.r, a.g - b.g, a.b - b.b); };
  for (int i = 0; i < 24; ++i) {
    const Color color = palette_color(i);
    for (const float channel : {color.r, color.g, color.b}) {
      EXPECT_GT(channel, 0.05F) << i;
      EXPECT_LT(channel, 0.98F) << i;
    }
    for (int j = i + 1; j < i + 8; ++j)
      EXPECT_GT(distance(color, palette_color(j)), 0.11) << i << " and " << j;
  }
}

TEST(Srgb, EncodingUndoesDecoding) {
  for (double x = 0; x <= 1; x += 0.01) EXPECT_NEAR(encode_srgb(decode_srgb(x)), x, 1e-6);
  EXPECT_NEAR(decode_srgb(0.5), 0.2140, 1e-4);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
