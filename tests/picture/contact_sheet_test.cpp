#include "softpoint/picture/contact_sheet.h"

#include "softpoint/picture/text.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(ContactSheet, LaysCellsOutRowByRow) {
  ContactSheetSettings settings;
  settings.columns = 3;
  settings.cell_width = 40;
  settings.gap = 5;
  ContactSheet sheet(settings);
  const Color colors[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
  for (const Color color : colors) sheet.add(Image(80, 60, color), "t = 1");
  const Image image = sheet.image();
  TextStyle style;
  const int caption = measure_text("x", style).height;
  EXPECT_EQ(image.width, 3 * 40 + 4 * 5);
  EXPECT_EQ(image.height, 2 * (30 + caption) + 3 * 5);
  const Vec3 expected[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 0}};
  for (int i = 0; i < 4; ++i) {
    const int left = 5 + (i % 3) * 45, top = 5 + (i / 3) * (35 + caption);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(39, 29), std::pair(20, 15)}) {
      const std::uint8_t* p = image.pixel(left + x, top + y);
      EXPECT_EQ(Vec3(p[0], p[1], p[2]), expected[i]) << i;
    }
    int dark = 0;
    for (int y = top + 30; y < top + 30 + caption; ++y) {
      for (int x = left; x < left + 40; ++x) dark += brightness(image.pixel(x, y)) < 300 ? 1 : 0;
    }
    EXPECT_GT(dark, 8) << "caption " << i;
  }
}

TEST(ContactSheet, NarrowsToTheFramesThereAre) {
  ContactSheet sheet({8, 32, 0, {}});
  sheet.add(Image(64, 32), "");
  sheet.add(Image(64, 32), "");
  EXPECT_EQ(sheet.image().width, 64);
}

TEST(ContactSheet, RefusesByName) {
  EXPECT_TRUE(mentions(refusal([] { ContactSheet({0, 32, 0, {}}); }), "columns = 0"));
  EXPECT_TRUE(mentions(refusal([] { ContactSheet({4, 8, 0, {}}); }), "cell_width = 8"));
  ContactSheet sheet({4, 32, 0, {}});
  EXPECT_TRUE(mentions(refusal([&] { sheet.image(); }), "frames = 0"));
  EXPECT_TRUE(mentions(refusal([&] { sheet.add(Image(31, 20), ""); }), "frame width = 31"));
  sheet.add(Image(64, 32), "");
  EXPECT_TRUE(mentions(refusal([&] { sheet.add(Image(64, 33), ""); }), "64x33"));
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
