#include "softpoint/picture/png.h"

#include <png.h>

#include <fstream>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

Image pattern(int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::uint8_t* p = image.pixel(x, y);
      p[0] = static_cast<std::uint8_t>(7 * x + y);
      p[1] = static_cast<std::uint8_t>(x * y);
      p[2] = static_cast<std::uint8_t>(255 - 3 * y);
    }
  }
  return image;
}

TEST(Png, ComesBackBitForBit) {
  const TemporaryFolder folder;
  const Image image = pattern(61, 47);
  for (int compression = 1; compression <= 3; ++compression) {
    write_png(folder.file("a.png"), image, compression);
    EXPECT_EQ(read_png(folder.file("a.png")), image) << compression;
  }
}

TEST(Png, IsReadByLibpngItself) {
  const TemporaryFolder folder;
  const Image image = pattern(20, 10);
  write_png(folder.file("a.png"), image);
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&header, folder.file("a.png").c_str()));
  EXPECT_EQ(header.width, 20U);
  EXPECT_EQ(header.height, 10U);
  EXPECT_EQ(header.format & PNG_FORMAT_FLAG_ALPHA, 0U) << "8-bit RGB without opacity";
  header.format = PNG_FORMAT_RGB;
  std::vector<png_byte> rgb(PNG_IMAGE_SIZE(header));
  ASSERT_TRUE(png_image_finish_read(&header, nullptr, rgb.data(), 0, nullptr));
  for (std::size_t i = 0; i < 200; ++i) {
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(rgb[3 * i + c], image.rgba[4 * i + c]);
  }
}

TEST(Png, ReportsWhatCannotBeWrittenOrRead) {
  const TemporaryFolder folder;
  const Image image = pattern(20, 10);
  EXPECT_TRUE(mentions(refusal([&] { write_png(folder.file("no/such/a.png"), image); }), "no/such/a.png"));
  EXPECT_TRUE(mentions(refusal([&] { write_png(folder.file("a.png"), image, 9); }), "compression = 9"));
  EXPECT_TRUE(mentions(refusal([&] { write_png(folder.file("a.png"), Image()); }), "at least one pixel"));
  EXPECT_TRUE(mentions(refusal([&] { read_png(folder.file("a.png")); }), "a.png"));
  std::ofstream(folder.file("b.png")) << "no picture";
  EXPECT_TRUE(mentions(refusal([&] { read_png(folder.file("b.png")); }), "b.png"));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(Png, AFullDiskIsReported) {
  // /dev/full takes nothing; 1 MB of noise does not fit the stream's buffer.
  Image image(600, 600);
  for (std::size_t i = 0; i < image.rgba.size(); ++i)
    image.rgba[i] = static_cast<std::uint8_t>(i * 2654435761U >> 13);
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.file("full.png"));
  EXPECT_TRUE(mentions(refusal([&] { write_png(folder.file("full.png"), image); }), "full.png"));
  EXPECT_EQ(folder.entries(), 0) << "nothing half-written stays";
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
