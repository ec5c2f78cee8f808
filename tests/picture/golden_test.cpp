#include "shapes.h"
#include "softpoint/picture/png.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

#ifndef PICTURE_GOLDEN_FOLDER
#error "the build names the folder of the golden pictures"
#endif

// A small scene that uses every part of the renderer.
Image small_scene(std::string& driver) {
  RenderSettings settings;
  settings.width = 192;
  settings.height = 108;
  settings.shadow_resolution = 512;
  Renderer renderer(settings);
  driver = renderer.driver();
  const int ball = add(renderer, unit_sphere(24, 12)), box = add(renderer, unit_box());
  renderer.begin(Camera{});
  renderer.draw_ground();
  Material material;
  material.color = palette_color(0);
  renderer.draw_mesh(box, material, placed({-1, 0.5, 0}, 0.5));
  material.color = palette_color(1);
  material.wetness = 1;
  renderer.draw_mesh(ball, material, placed({0.6, 0.7, 0.2}, 0.7));
  material.color = palette_color(2);
  material.wetness = 0;
  material.wireframe = true;
  renderer.draw_mesh(ball, material, placed({-0.2, 0.3, 1.6}, 0.3));
  renderer.draw_arrow({0.6, 1.4, 0.2}, {0, 0.6, 0}, {0.8F, 0.2F, 0.1F}, 0.04);
  renderer.draw_line({-1, 1, 0}, {0.6, 1.4, 0.2}, {0.1F, 0.1F, 0.1F});
  renderer.draw_point({-1, 1, 0}, {0.9F, 0.7F, 0.1F}, 3);
  renderer.draw_text(4, 4, "t = 0.5 s");
  return renderer.finish();
}

// Pictures are equal bit by bit on the driver they were made with; another Mesa version or processor rounds
// otherwise, and gets some leeway.
TEST(Golden, SmallScene) {
  constexpr std::string_view kDriver = "llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6";
  std::string driver;
  const Image image = small_scene(driver);
  const Image golden = read_png(PICTURE_GOLDEN_FOLDER "/small_scene.png");
  if (driver == kDriver) {
    EXPECT_EQ(hash(image), hash(golden)) << "peak signal-to-noise ratio " << psnr(image, golden) << " dB";
  } else {
    EXPECT_GT(psnr(image, golden), 35) << driver;
  }
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
