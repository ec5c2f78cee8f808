#include "light.h"

#include <Eigen/Geometry>

#include "shapes.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// Does the ray from `from` along `direction` hit the box of half extents `half` round `center`?
bool hits_box(const Vec3& from, const Vec3& direction, const Vec3& center, const Vec3& half) {
  double enter = 0, leave = 1e9;
  for (int c = 0; c < 3; ++c) {
    double a = (center[c] - half[c] - from[c]) / direction[c],
           b = (center[c] + half[c] - from[c]) / direction[c];
    if (a > b) std::swap(a, b);
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  return enter < leave;
}

TEST(Shadow, DarkensTheGroundWhereTheBoxHidesTheLight) {
  RenderSettings settings = plain_settings(320, 240);
  settings.grid = false;
  settings.shadow_resolution = 1024;
  Camera camera;
  camera.eye = {0.5, 6, 7};
  camera.target = {0, 0, 0};
  const Vec3 center(0.2, 1.2, 0.1), half(0.6, 0.3, 0.4);
  const auto render = [&](bool shadows) {
    settings.shadows = shadows;
    Renderer renderer(settings);
    const int box = add(renderer, unit_box());
    renderer.begin(camera);
    renderer.draw_ground();
    Pose pose;
    pose.linear = half.asDiagonal();
    pose.origin = center;
    renderer.draw_mesh(box, {}, pose);
    return renderer.finish();
  };
  const Image with = render(true), without = render(false);
  const Vec3 to_light = direction_to_light(settings, camera.up);
  const Vec3 margin(0.1, 0.1, 0.1);  // the width of the penumbra is left undecided
  int dark = 0, lit = 0;
  for (double x = -3; x <= 3; x += 0.05) {
    for (double z = -3; z <= 3; z += 0.05) {
      const Vec3 ground(x, 0, z);
      if (hits_box(ground, camera.eye - ground, center, half + margin)) continue;  // box in front
      const Projected at = project(camera, settings.width, settings.height, ground);
      const int px = static_cast<int>(at.x), py = static_cast<int>(at.y);
      if (at.x < 0 || at.y < 0 || px >= settings.width || py >= settings.height) continue;
      if (hits_box(ground, to_light, center, half - margin)) {
        ++dark;
        EXPECT_LT(brightness(with.pixel(px, py)), 0.8 * brightness(without.pixel(px, py))) << x << " " << z;
      } else if (!hits_box(ground, to_light, center, half + margin)) {
        ++lit;
        EXPECT_EQ(brightness(with.pixel(px, py)), brightness(without.pixel(px, py))) << x << " " << z;
      }
    }
  }
  EXPECT_GT(dark, 50);
  EXPECT_GT(lit, 4000);
}

// The shadow of a box that stands outside of the picture, in the direction of the light.
Image shadow_on_floor(const RenderSettings& settings, bool with_box, RenderStats& stats) {
  Renderer renderer(settings);
  const int box = add(renderer, unit_box());
  const Camera camera;
  renderer.begin(camera);
  renderer.draw_ground();
  const Vec3 above = 12 * direction_to_light(settings, camera.up);
  if (with_box) renderer.draw_mesh(box, {}, placed(above, 0.6));
  const Image image = renderer.finish();
  stats = renderer.stats();
  return image;
}

RenderSettings floor_settings() {
  RenderSettings settings = plain_settings();
  settings.grid = false;
  settings.shadows = true;
  return settings;
}

TEST(Shadow, SoftnessWidensThePenumbra) {
  RenderSettings settings = floor_settings();
  RenderStats stats;
  const Image lit = shadow_on_floor(settings, false, stats);
  const auto partly_lit = [&](double softness) {
    settings.shadow_softness = softness;
    const Image image = shadow_on_floor(settings, true, stats);
    int count = 0, darkest = 1000;
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) darkest = std::min(darkest, brightness(image.pixel(x, y)));
    }
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const int value = brightness(image.pixel(x, y));
        count += value > darkest + 40 && value < brightness(lit.pixel(x, y)) - 40 ? 1 : 0;
      }
    }
    return count;
  };
  const int sharp = partly_lit(0), soft = partly_lit(0.04);
  EXPECT_GT(soft, 3 * sharp);
  EXPECT_GT(sharp, 0) << "filtered even so";
}

TEST(Shadow, IsThrownByThingsOutsideThePicture) {
  const RenderSettings settings = floor_settings();
  RenderStats stats;
  const Image empty = shadow_on_floor(settings, false, stats);
  const Image shadowed = shadow_on_floor(settings, true, stats);
  EXPECT_EQ(stats.meshes_drawn, 0);
  EXPECT_EQ(stats.casters_drawn, 1);
  const Projected at = project(Camera{}, settings.width, settings.height, {0, 0, 0});
  const int x = static_cast<int>(at.x), y = static_cast<int>(at.y);
  EXPECT_LT(brightness(shadowed.pixel(x, y)), 0.8 * brightness(empty.pixel(x, y)));
}

TEST(Shadow, NoLitFaceShadowsItself) {
  // A ball with and without the shadow map differs only where it turns away from the light.
  RenderSettings settings = plain_settings(320, 240);
  const auto render = [&](bool shadows) {
    settings.shadows = shadows;
    Renderer renderer(settings);
    const int ball = add(renderer, unit_sphere(64, 32));
    renderer.begin(front_camera(4));
    renderer.draw_mesh(ball);
    return renderer.finish();
  };
  const Image with = render(true), without = render(false);
  const Vec3 to_light = direction_to_light(settings, {0, 1, 0});
  const Camera camera = front_camera(4);
  int checked = 0;
  for (double x = -0.9; x < 0.9; x += 0.05) {
    for (double y = -0.9; y < 0.9; y += 0.05) {
      if (x * x + y * y > 0.7) continue;
      const Vec3 normal(x, y, std::sqrt(1 - x * x - y * y));
      if (normal.dot(to_light) < 0.25) continue;
      const Projected at = project(camera, settings.width, settings.height, normal);
      const int px = static_cast<int>(at.x), py = static_cast<int>(at.y);
      EXPECT_NEAR(brightness(with.pixel(px, py)), brightness(without.pixel(px, py)), 3) << x << " " << y;
      ++checked;
    }
  }
  EXPECT_GT(checked, 200);
}

TEST(Light, GrowsWithTheCosineOfItsAngle) {
  // A vertical plate turned round the vertical: sky light stays, only the angle to the light changes.
  const RenderSettings settings = plain_settings();
  Renderer renderer(settings);
  TriangleMesh plate;
  plate.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  plate.triangles = {{0, 1, 2}, {0, 2, 3}};
  const int mesh = add(renderer, plate);
  const Vec3 to_light = direction_to_light(settings, {0, 1, 0});
  const double toward = std::atan2(to_light.x(), to_light.z());
  Material chalk;
  chalk.roughness = 1;
  int previous = 1000, first = 0, last = 0;
  for (int step = 0; step <= 8; ++step) {
    const double turn = toward + 10 * step * 3.14159265358979323846 / 180;
    Pose pose;
    pose.linear = Eigen::AngleAxisd(turn, Vec3::UnitY()).toRotationMatrix();
    Camera camera;
    camera.eye = 5 * pose.linear.col(2);
    camera.target = {0, 0, 0};
    renderer.begin(camera);
    renderer.draw_mesh(mesh, chalk, pose);
    const Image image = renderer.finish();
    const int now = brightness(image.pixel(80, 60));
    EXPECT_LE(now, previous) << "at " << 10 * step << " degrees from the light";
    (step == 0 ? first : last) = now;
    previous = now;
  }
  EXPECT_GT(first, last + 60);
}

TEST(Light, WetSkinIsDarkerWithABrighterHighlight) {
  Renderer renderer(plain_settings());
  const int ball = add(renderer, unit_sphere(48, 24));
  const auto range = [&](double wetness) {
    Material material;
    material.color = {0.5F, 0.4F, 0.3F};
    material.wetness = wetness;
    renderer.begin(front_camera(4));
    renderer.draw_mesh(ball, material);
    const Image image = renderer.finish();
    int brightest = 0, middle = brightness(image.pixel(80, 68));
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const std::uint8_t* p = image.pixel(x, y);
        if (std::hypot(x - 80, y - 60) < 25) brightest = std::max(brightest, brightness(p));
      }
    }
    return std::pair(brightest, middle);
  };
  const auto dry = range(0), wet = range(1);
  EXPECT_GT(wet.first, dry.first + 40);
  EXPECT_LT(wet.second, dry.second - 10);
}

TEST(Ground, IsSeenFromAboveOnly) {
  Renderer renderer(plain_settings());
  const auto drawn_from = [&](double height) {
    Camera camera;
    camera.eye = {0, height, 5};
    camera.target = {0, 0, 0};
    renderer.begin(camera);
    renderer.draw_ground();
    return count_drawn(renderer.finish());
  };
  EXPECT_GT(drawn_from(2), 10000);
  EXPECT_EQ(drawn_from(-2), 0);
}

TEST(Ground, GridLinesLieOnMultiplesOfTheSpacing) {
  RenderSettings settings = plain_settings(320, 240);
  settings.grid_spacing = 0.5;
  Renderer renderer(settings);
  Camera camera;
  camera.eye = {0.3, 4, 0.1};
  camera.target = {0.3, 0, 0};
  renderer.begin(camera);
  renderer.draw_ground();
  const Image image = renderer.finish();
  const auto at = [&](double x, double z) {
    const Projected p = project(camera, settings.width, settings.height, {x, 0, z});
    return brightness(image.pixel(static_cast<int>(p.x), static_cast<int>(p.y)));
  };
  for (const double k : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    EXPECT_LT(at(k, 0.25), at(k + 0.25, 0.25) - 10) << "x = " << k;
    EXPECT_LT(at(0.25, k), at(0.25, k + 0.25) - 10) << "z = " << k;
  }
}

TEST(Ground, FadesIntoTheSky) {
  RenderSettings settings = plain_settings(320, 240);
  settings.sky = true;
  Renderer renderer(settings);
  Camera camera;
  camera.eye = {0, 1, 0};
  camera.target = {0, 1, -5};  // level: the horizon runs through the middle
  renderer.begin(camera);
  renderer.draw_ground();
  const Image image = renderer.finish();
  for (int x = 0; x < 320; x += 20) {
    EXPECT_NEAR(brightness(image.pixel(x, 121)), brightness(image.pixel(x, 117)), 24) << x;
  }
  EXPECT_GT(std::abs(brightness(image.pixel(160, 239)) - brightness(image.pixel(160, 0))), 40);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
