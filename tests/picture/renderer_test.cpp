#include "shapes.h"

#include <numbers>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

using std::numbers::pi;

TEST(Renderer, SphereCoversTheAreaOfItsCone) {
  const RenderSettings settings = plain_settings(320, 240);
  Renderer renderer(settings);
  const int ball = add(renderer, unit_sphere(96, 48));
  Material red;
  red.color = {0.9F, 0.1F, 0.1F};
  renderer.begin(front_camera(5));
  renderer.draw_mesh(ball, red);
  const Image image = renderer.finish();
  // The tangent cone of the unit sphere at distance 5 has sin(angle) = 1/5.
  const double pixels_per_unit = 0.5 * settings.height / std::tan(20 * pi / 180);
  const double radius = std::tan(std::asin(1.0 / 5)) * pixels_per_unit;
  const double expected = pi * radius * radius;
  double covered = 0;  // fully white pixels count 0, half covered ones half
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.pixel(x, y);
      const bool inside = std::hypot(x + 0.5 - 160, y + 0.5 - 120) < radius - 2;
      covered += inside ? 1.0 : is_white(p) ? 0.0 : 0.5;
      if (inside) {
        EXPECT_GT(p[0], p[1] + 20) << x << " " << y;
      }
      if (std::hypot(x + 0.5 - 160, y + 0.5 - 120) > radius + 2) {
        EXPECT_TRUE(is_white(p)) << x << " " << y;
      }
    }
  }
  // The rim of about 2 pi r pixels is counted as half covered.
  const int drawn = count_drawn(image);
  EXPECT_NEAR(drawn - 0.5 * 2 * pi * radius, expected, 0.02 * expected);
  EXPECT_GT(covered, 0.95 * expected);
}

TEST(Renderer, NearerThingsHideFartherOnesInAnyOrder) {
  Renderer renderer(plain_settings());
  const int ball = add(renderer, unit_sphere(32, 16));
  Material red, blue;
  red.color = {0.9F, 0.05F, 0.05F};
  blue.color = {0.05F, 0.05F, 0.9F};
  Image first, second;
  renderer.begin(front_camera(8));
  renderer.draw_mesh(ball, red, placed({0, 0, 2}, 0.5));
  renderer.draw_mesh(ball, blue, placed({0, 0, 0}));
  renderer.finish(first);
  renderer.begin(front_camera(8));
  renderer.draw_mesh(ball, blue, placed({0, 0, 0}));
  renderer.draw_mesh(ball, red, placed({0, 0, 2}, 0.5));
  renderer.finish(second);
  EXPECT_EQ(first, second);
  const std::uint8_t* middle = first.pixel(80, 60);
  EXPECT_GT(middle[0], middle[2] + 50);
  // Beside the small ball, but on the large one.
  const std::uint8_t* beside = first.pixel(80, 60 - 16);
  EXPECT_GT(beside[2], beside[0] + 50);
}

TEST(Renderer, RepeatsEveryBit) {
  RenderSettings settings = plain_settings();
  settings.shadows = true;
  settings.sky = true;
  const auto render = [&settings] {
    Renderer renderer(settings);
    const int ball = add(renderer, unit_sphere(32, 16));
    renderer.begin(Camera{});
    renderer.draw_ground();
    renderer.draw_mesh(ball, {}, placed({0, 1, 0}));
    renderer.draw_line({0, 0, 0}, {1, 2, 1}, {1, 0, 0});
    renderer.draw_text(3, 3, "t = 0");
    return renderer.finish();
  };
  const Image first = render();
  EXPECT_EQ(first, render());
  EXPECT_EQ(count_pixels(first, [](const std::uint8_t* p) { return p[3] != 255; }), 0) << "opaque throughout";
}

TEST(Renderer, SeveralLiveSideBySide) {
  Renderer small(plain_settings(64, 48)), large(plain_settings(160, 120));
  const int a = add(small, unit_sphere(24, 12)), b = add(large, unit_sphere(24, 12));
  small.begin(front_camera(4));
  large.begin(front_camera(4));
  small.draw_mesh(a);
  large.draw_mesh(b);
  const Image large_image = large.finish(), small_image = small.finish();
  EXPECT_EQ(small_image.width, 64);
  EXPECT_EQ(large_image.width, 160);
  const double ratio = static_cast<double>(count_drawn(large_image)) / count_drawn(small_image);
  EXPECT_NEAR(ratio, 2.5 * 2.5, 0.7);
}

TEST(Renderer, CullsWhatTheCameraCannotSee) {
  RenderSettings settings = plain_settings();
  settings.shadows = true;
  Renderer renderer(settings);
  const int ball = add(renderer, unit_sphere(16, 8));
  renderer.begin(front_camera(6));
  renderer.draw_mesh(ball, {}, placed({0, 0, 0}));
  renderer.draw_mesh(ball, {}, placed({0, 0, 20}));    // behind the eye
  renderer.draw_mesh(ball, {}, placed({0, -30, 0}));   // below: its shadow falls away from the picture
  renderer.draw_mesh(ball, {}, placed({500, 0, -9}));  // far to the side
  renderer.finish();
  const RenderStats& stats = renderer.stats();
  EXPECT_EQ(stats.meshes_drawn, 1);
  EXPECT_EQ(stats.meshes_culled, 3);
  EXPECT_EQ(stats.triangles_drawn, unit_sphere(16, 8).triangle_count());
  EXPECT_GE(stats.casters_drawn, 1);
  EXPECT_GE(stats.casters_culled, 1);
  EXPECT_EQ(stats.casters_drawn + stats.casters_culled, 4);
}

TEST(Renderer, CulledThingsWouldNotHaveShown) {
  // Balls all over the place, one by one: a culled one leaves the picture as it is.
  Renderer renderer(plain_settings(64, 48));
  const int ball = add(renderer, unit_sphere(16, 8));
  int culled = 0, shown = 0;
  for (int i = 0; i < 120; ++i) {
    const Vec3 place(9 * std::sin(1.7 * i), 7 * std::sin(2.3 * i + 1), 9 * std::sin(3.1 * i + 2));
    renderer.begin(front_camera(6));
    renderer.draw_mesh(ball, {}, placed(place, 0.4));
    const Image image = renderer.finish();
    const bool empty = count_drawn(image) == 0;
    if (renderer.stats().meshes_culled == 1) {
      ++culled;
      EXPECT_TRUE(empty) << place.transpose();
    } else {
      shown += empty ? 0 : 1;
    }
  }
  EXPECT_GT(culled, 10);
  EXPECT_GT(shown, 10);
}

TEST(Renderer, UploadsOnlyWhatMovedAndIsSeen) {
  Renderer renderer(plain_settings());
  const TriangleMesh sphere = unit_sphere(16, 8);
  const int ball = add(renderer, sphere);
  const auto uploads = [&](const Vec3& place) {
    renderer.begin(front_camera(6));
    renderer.draw_mesh(ball, {}, placed(place));
    renderer.finish();
    return renderer.stats().meshes_uploaded;
  };
  EXPECT_EQ(uploads({0, 0, 30}), 0) << "unseen";
  EXPECT_EQ(uploads({0, 0, 0}), 1);
  EXPECT_EQ(uploads({0.1, 0, 0}), 0) << "a pose needs no upload";
  renderer.update_mesh(ball, sphere.vertices);
  EXPECT_EQ(uploads({0, 0, 30}), 0) << "unseen";
  EXPECT_EQ(uploads({0, 0, 0}), 1);
}

TEST(Renderer, MovedVerticesMoveThePicture) {
  Renderer renderer(plain_settings());
  TriangleMesh sphere = unit_sphere(24, 12);
  const int ball = add(renderer, sphere);
  renderer.begin(front_camera(6));
  renderer.draw_mesh(ball);
  const int before = count_drawn(renderer.finish());
  for (Vec3& p : sphere.vertices) p *= 0.5;
  renderer.update_mesh(ball, sphere.vertices);
  renderer.begin(front_camera(6));
  renderer.draw_mesh(ball);
  const int after = count_drawn(renderer.finish());
  EXPECT_NEAR(static_cast<double>(before) / after, 4.0, 0.4);
}

TEST(Renderer, FarFromTheOriginThingsLookTheSame) {
  Renderer renderer(plain_settings());
  const int ball = add(renderer, unit_sphere(24, 12));
  const auto render = [&](const Vec3& shift) {
    Camera camera = front_camera(6);
    camera.eye += shift;
    camera.target += shift;
    renderer.begin(camera);
    renderer.draw_mesh(ball, {}, placed(shift));
    return renderer.finish();
  };
  EXPECT_GT(psnr(render({0, 0, 0}), render({1e6, -2e6, 3e6})), 45);
}

TEST(Renderer, LeavesOutWhatIsNotFinite) {
  Renderer renderer(plain_settings());
  TriangleMesh sphere = unit_sphere(16, 8);
  const int ball = add(renderer, sphere);
  const double nan = std::nan("");
  renderer.begin(front_camera(6));
  renderer.draw_mesh(ball, {}, placed({nan, 0, 0}));
  sphere.vertices[3].y() = nan;
  renderer.update_mesh(ball, sphere.vertices);
  renderer.draw_mesh(ball);
  renderer.draw_line({nan, 0, 0}, {1, 1, 1}, {});
  renderer.draw_point({0, nan, 0}, {});
  renderer.draw_triangle({0, 0, 0}, {1, 0, 0}, {0, nan, 0}, {});
  renderer.draw_arrow({0, 0, 0}, {nan, 0, 0}, {}, 0.1);
  renderer.draw_ground({0, nan, 0});
  renderer.draw_text(nan, 0, "text");
  renderer.draw_label({nan, 0, 0}, "text");
  const Image image = renderer.finish();
  EXPECT_EQ(renderer.stats().skipped_not_finite, 9);
  EXPECT_EQ(count_drawn(image), 0);
}

TEST(Renderer, RefusesSettingsByName) {
  const auto refused = [](auto change) {
    RenderSettings settings = plain_settings();
    change(settings);
    return refusal([&] { Renderer renderer(settings); });
  };
  EXPECT_TRUE(mentions(refused([](auto& s) { s.width = 15; }), "width = 15: permitted is 16 to 8192"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.height = 8193; }), "height = 8193"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.samples = 3; }), "samples = 3"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.shadow_resolution = 0; }), "shadow_resolution = 0"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.shadow_softness = 1; }), "shadow_softness = 1"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.light_elevation_degrees = 0; }), "light_elevation_degrees"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.light_azimuth_degrees = std::nan(""); }), "light_azimuth"));
  EXPECT_TRUE(mentions(refused([](auto& s) { s.grid_spacing = -1; }), "grid_spacing = -1"));
  EXPECT_EQ(refused([](auto&) {}), "");
}

TEST(Renderer, RefusesCallsOutOfTurn) {
  Renderer renderer(plain_settings());
  const int ball = add(renderer, unit_sphere(16, 8));
  EXPECT_TRUE(mentions(refusal([&] { renderer.draw_mesh(ball); }), "draw_mesh"));
  EXPECT_TRUE(mentions(refusal([&] { renderer.finish(); }), "finish"));
  renderer.begin(front_camera(5));
  EXPECT_TRUE(mentions(refusal([&] { renderer.draw_mesh(99); }), "mesh = 99"));
  renderer.finish();
  renderer.remove_mesh(ball);
  EXPECT_TRUE(mentions(refusal([&] { renderer.remove_mesh(ball); }), "removed"));
}

TEST(Renderer, ShowsAMeshRemovedAfterItWasDrawnInTheFrame) {
  Renderer renderer(plain_settings());
  const int ball = add(renderer, unit_sphere(16, 8));
  renderer.begin(front_camera(5));
  renderer.draw_mesh(ball);
  renderer.remove_mesh(ball);
  const int box = add(renderer, unit_box());
  EXPECT_NE(box, ball) << "the number is not free before the frame is finished";
  EXPECT_GT(count_drawn(renderer.finish()), 500);
  EXPECT_EQ(add(renderer, unit_box()), ball);
}

TEST(Renderer, OneSampleIsAllowed) {
  RenderSettings settings = plain_settings();
  settings.samples = 1;
  Renderer renderer(settings);
  const int ball = add(renderer, unit_sphere(16, 8));
  renderer.begin(front_camera(5));
  renderer.draw_mesh(ball);
  EXPECT_GT(count_drawn(renderer.finish()), 500);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
