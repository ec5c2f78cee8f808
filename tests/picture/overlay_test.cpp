#include "shapes.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(Overlay, LineIsAsWideAndLongAsAsked) {
  Renderer renderer(plain_settings(160, 120));
  const double pixels_per_metre = 60 / (5 * std::tan(20 * 3.14159265358979323846 / 180));
  for (const double width : {1.0, 2.0, 5.0}) {
    renderer.begin(front_camera(5));
    renderer.draw_line({-1, 0.02, 0}, {1, 0.02, 0}, {0, 0, 0}, width);
    const Image image = renderer.finish();
    double ink = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) ink += (255 - image.pixel(x, y)[0]) / 255.0;
    }
    EXPECT_NEAR(ink, width * (2 * pixels_per_metre + 0.7 * width), 0.12 * ink) << width;
  }
}

TEST(Overlay, LineThatRunsPastTheEyeIsCutNotSmeared) {
  Renderer renderer(plain_settings());
  renderer.begin(front_camera(5));
  renderer.draw_line({-1, -0.5, 0}, {-1, -0.5, 40}, {0, 0, 0}, 2);
  const Image image = renderer.finish();
  const int drawn = count_drawn(image);
  EXPECT_GT(drawn, 20);
  EXPECT_LT(drawn, 600);
  EXPECT_EQ(count_pixels(image,
                         [&image](const std::uint8_t* p) {
                           return !is_white(p) && (p - image.rgba.data()) / 4 % image.width > 80;
                         }),
            0)
      << "it lies left of the middle throughout";
}

TEST(Overlay, SolidsHideLinesUnlessSeeThrough) {
  Renderer renderer(plain_settings());
  const int box = add(renderer, unit_box());
  const auto render = [&](bool line, bool see_through) {
    renderer.begin(front_camera(6));
    renderer.draw_mesh(box);
    if (line) renderer.draw_line({-0.5, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, 2, see_through);
    if (line) renderer.draw_point({0, 0.5, 0}, {1, 0, 0}, 4, see_through);
    return renderer.finish();
  };
  const Image bare = render(false, false);
  EXPECT_EQ(count_different(bare, render(true, false)), 0);
  EXPECT_GT(count_different(bare, render(true, true)), 50);
}

TEST(Overlay, PointIsADisc) {
  Renderer renderer(plain_settings());
  renderer.begin(front_camera(5));
  renderer.draw_point({0, 0, 0}, {0.8F, 0, 0}, 10);
  const Image image = renderer.finish();
  EXPECT_NEAR(count_drawn(image), 3.14159 * 10 * 10, 60);
  EXPECT_FALSE(is_white(image.pixel(80, 60)));
  EXPECT_TRUE(is_white(image.pixel(80 + 9, 60 + 9)));
}

TEST(Overlay, TriangleBlendsByItsOpacity) {
  Renderer renderer(plain_settings());
  renderer.begin(front_camera(5));
  renderer.draw_triangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, 0, 0.5F});
  const Image image = renderer.finish();
  EXPECT_NEAR(image.pixel(80, 60)[0], 128, 2);
  EXPECT_EQ(image.pixel(80, 60)[3], 255);
}

TEST(Overlay, ArrowPointsWhereItShould) {
  Renderer renderer(plain_settings(320, 240));
  renderer.begin(front_camera(5));
  renderer.draw_arrow({-1, 0, 0}, {2, 0, 0}, {0.8F, 0.1F, 0.1F}, 0.05);
  const Image image = renderer.finish();
  const auto thickness = [&](double x) {
    const Projected at = project(front_camera(5), 320, 240, {x, 0, 0});
    int count = 0;
    for (int y = 0; y < 240; ++y) count += is_white(image.pixel(static_cast<int>(at.x), y)) ? 0 : 1;
    return count;
  };
  const double pixels_per_metre = 120 / (5 * std::tan(20 * 3.14159265358979323846 / 180));
  EXPECT_NEAR(thickness(0), 0.1 * pixels_per_metre, 3);
  EXPECT_GT(thickness(0.72), 1.7 * thickness(0)) << "the head is wider";
  EXPECT_LT(thickness(0.95), thickness(0.72)) << "and ends in a tip";
  EXPECT_EQ(thickness(1.1), 0);
  EXPECT_EQ(thickness(-1.1), 0);
}

TEST(Overlay, ShortArrowsKeepTheirLength) {
  Renderer renderer(plain_settings(320, 240));
  renderer.begin(front_camera(5));
  renderer.draw_arrow({0, 0, 0}, {0.1, 0, 0}, {0.8F, 0.1F, 0.1F}, 0.5);
  renderer.draw_arrow({0, 1, 0}, {0, 0, 0}, {0.8F, 0.1F, 0.1F}, 0.5);
  const Image image = renderer.finish();
  const double end = project(front_camera(5), 320, 240, {0.1, 0, 0}).x;
  for (int y = 0; y < 240; ++y) {
    for (int x = static_cast<int>(end) + 3; x < 320; ++x) {
      EXPECT_TRUE(is_white(image.pixel(x, y))) << x << " " << y;
    }
  }
  EXPECT_GT(count_drawn(image), 0);
}

TEST(Overlay, WireframeDrawsTheEdges) {
  Renderer renderer(plain_settings(320, 240));
  const int box = add(renderer, unit_box());
  const auto render = [&](bool wireframe) {
    Material material;
    material.wireframe = wireframe;
    renderer.begin(front_camera(6));
    renderer.draw_mesh(box, material);
    return renderer.finish();
  };
  const Image plain = render(false), wired = render(true);
  EXPECT_GT(count_different(plain, wired), 300);
  // The diagonal of the front face passes through the middle.
  EXPECT_LT(brightness(wired.pixel(160, 120)) + 30, brightness(plain.pixel(160, 120)));
  // Between the edges nothing changes.
  const Projected inside = project(front_camera(6), 320, 240, {0.6, 0.0, 1});
  const int x = static_cast<int>(inside.x), y = static_cast<int>(inside.y);
  EXPECT_EQ(brightness(wired.pixel(x, y)), brightness(plain.pixel(x, y)));
}

TEST(Overlay, LabelStandsBesideItsAnchor) {
  Renderer renderer(plain_settings(320, 240));
  renderer.begin(front_camera(5));
  renderer.draw_label({0.5, 0.3, 0}, "x");
  renderer.draw_label({0, 0, 50}, "behind");
  const Image image = renderer.finish();
  const Projected anchor = project(front_camera(5), 320, 240, {0.5, 0.3, 0});
  int dark = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (brightness(image.pixel(x, y)) > 500) continue;
      ++dark;
      EXPECT_GT(x, anchor.x);
      EXPECT_LT(std::hypot(x - anchor.x, y - anchor.y), 40);
    }
  }
  EXPECT_GT(dark, 8);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
