// Every number of the settings of pictures, tried with NaN, infinities, negative, zero and huge values.
#include <gtest/gtest.h>

#include <LinearMath/btVector3.h>

#include "picture/support.h"
#include "softpoint/core/limits.h"
#include "softpoint/core/shapes.h"
#include "softpoint/picture/contact_sheet.h"
#include "softpoint/picture/debug_drawer.h"
#include "softpoint/picture/video.h"
#include "support/field_table.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

Fields fields_of(Color& color, const std::string& name) {
  auto& [r, g, b, a] = color;
  constexpr double kAny = kLargest;  // finite ones are clamped
  return {{name + " r", r, -kAny, kAny},
          {name + " g", g, -kAny, kAny},
          {name + " b", b, -kAny, kAny},
          {name + " a", a, -kAny, kAny}};
}

// A ball on a floor, with a line, a label and an arrow.
Image draw_scene(Renderer& renderer, const Camera& camera = {}, const Material& material = {},
                 const TextStyle& style = {}) {
  static const TriangleMesh ball = sphere(0.5, 1);
  const int mesh = renderer.add_mesh(ball.vertices, ball.triangles);
  renderer.begin(camera);
  renderer.draw_ground();
  renderer.draw_mesh(mesh, material);
  renderer.draw_line({0, 0, 0}, {1, 1, 0}, {1, 0, 0});
  renderer.draw_arrow({0, 1, 0}, {0, 1, 0}, {0, 1, 0}, 0.02);
  renderer.draw_label({0, 1, 0}, "ball", style);
  Image image = renderer.finish();
  renderer.remove_mesh(mesh);
  return image;
}

bool is_whole(const Image& image, int width, int height) {
  return image.width == width && image.height == height &&
         image.rgba.size() == 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

TEST(EveryField, OfRenderSettings) {
  RenderSettings small = plain_settings(32, 24);
  small.shadows = true;
  small.shadow_resolution = 64;
  small.samples = 1;
  expect_every_field<RenderSettings>(
      small,
      [](RenderSettings& settings) {
        auto& [backend, width, height, samples, shadows, shadow_resolution, shadow_softness,
               light_azimuth_degrees, light_elevation_degrees, grid, grid_spacing, sky, background] =
            settings;
        static_assert(std::is_enum_v<std::remove_reference_t<decltype(backend)>> &&
                      std::is_same_v<decltype(shadows), bool> && std::is_same_v<decltype(grid), bool> &&
                      std::is_same_v<decltype(sky), bool>);
        Fields fields{{"width", width, 16, 8192},
                      {"height", height, 16, 8192},
                      {"samples", samples, 1, 0, {1, 4}},
                      {"shadow_resolution", shadow_resolution, 64, 8192},
                      {"shadow_softness", shadow_softness, 0, 0.1},
                      {"light_azimuth_degrees", light_azimuth_degrees, -360, 360},
                      {"light_elevation_degrees", light_elevation_degrees, 5, 90},
                      {"grid_spacing", grid_spacing, 1e-6, 1e9, {0}}};
        add_fields(fields, fields_of(background, "background"));
        return fields;
      },
      [](const RenderSettings& settings) {
        Renderer renderer(settings);
        return is_whole(draw_scene(renderer), settings.width, settings.height);
      });
}

TEST(EveryField, OfACamera) {
  Renderer renderer(plain_settings(32, 24));
  Camera kept;
  kept.eye = {1, 2, 3};
  draw_scene(renderer, kept);
  const auto state = [&] {
    return to_text(renderer.camera().eye) + to_text(renderer.camera().vertical_fov_degrees);
  };
  expect_every_field<Camera>(
      {},
      [](Camera& camera) {
        auto& [eye, target, up, vertical_fov_degrees] = camera;
        Fields fields{{"vertical_fov_degrees", vertical_fov_degrees, 1, 150}};
        add_fields(fields, "eye", eye, -kFarthest, kFarthest);
        add_fields(fields, "target", target, -kFarthest, kFarthest);
        add_fields(fields, "up", up, -1e9, 1e9);
        return fields;
      },
      [&](const Camera& camera) { return is_whole(draw_scene(renderer, camera), 32, 24); }, state,
      Range::necessary);  // up may lie along the line of sight
}

TEST(EveryField, OfFramingABox) {
  struct Box {
    Vec3 low{-1, -1, -1}, high{1, 1, 1}, direction{-1, -0.5, -1};
    double aspect = 1.5;
  };
  expect_every_field<Box>(
      {},
      [](Box& box) {
        Fields fields{{"aspect", box.aspect, 1e-3, 1e3}};
        add_fields(fields, "low", box.low, -kFarthest, kFarthest);
        add_fields(fields, "high", box.high, -kFarthest, kFarthest);
        add_fields(fields, "direction", box.direction, -kFarthest, kFarthest);
        return fields;
      },
      [](const Box& box) {
        const Camera camera = frame_box(box.low, box.high, box.direction, box.aspect);
        return camera.eye.allFinite() && camera.target.allFinite();
      },
      [] { return std::string(); }, Range::necessary);
}

TEST(EveryField, OfAMaterial) {
  Renderer renderer(plain_settings(32, 24));
  expect_every_field<Material>(
      {},
      [](Material& material) {
        auto& [color, roughness, wetness, two_sided, casts_shadow, wireframe] = material;
        static_assert(std::is_same_v<decltype(two_sided), bool> &&
                      std::is_same_v<decltype(casts_shadow), bool> &&
                      std::is_same_v<decltype(wireframe), bool>);
        Fields fields{{"roughness", roughness, -kLargest, kLargest},
                      {"wetness", wetness, -kLargest, kLargest}};
        add_fields(fields, fields_of(color, "color"));
        return fields;
      },
      [&](const Material& material) { return is_whole(draw_scene(renderer, {}, material), 32, 24); });
}

TEST(EveryField, OfATextStyle) {
  Renderer renderer(plain_settings(32, 24));
  expect_every_field<TextStyle>(
      {},
      [](TextStyle& style) {
        auto& [color, scale, backing] = style;
        Fields fields{{"scale", scale, 0.5, 16}};
        add_fields(fields, fields_of(color, "color"));
        add_fields(fields, fields_of(backing, "backing"));
        return fields;
      },
      [&](const TextStyle& style) {
        Image image(64, 32);
        draw_text(image, 1, 1, "text", style);
        return is_whole(draw_scene(renderer, {}, {}, style), 32, 24);
      });
}

TEST(EveryField, OfAContactSheet) {
  expect_every_field<ContactSheetSettings>(
      {2, 16, 2},
      [](ContactSheetSettings& settings) {
        auto& [columns, cell_width, gap, paper] = settings;
        Fields fields{
            {"columns", columns, 1, 64}, {"cell_width", cell_width, 16, 4096}, {"gap", gap, 0, 100}};
        add_fields(fields, fields_of(paper, "paper"));
        return fields;
      },
      [](const ContactSheetSettings& settings) {
        ContactSheet sheet(settings);
        sheet.add(Image(settings.cell_width, 16), "one");
        sheet.add(Image(settings.cell_width, 16), "two");
        return sheet.image().width > settings.cell_width;
      });
}

TEST(EveryField, OfADebugDrawer) {
  Renderer renderer(plain_settings(32, 24));
  expect_every_field<DebugStyle>(
      {},
      [](DebugStyle& style) {
        auto& [line_pixels, contact_pixels, contact_length, see_through] = style;
        static_assert(std::is_same_v<decltype(see_through), bool>);
        return Fields{{"line_pixels", line_pixels, 0.1, 1000},
                      {"contact_pixels", contact_pixels, 0.1, 1000},
                      {"contact_length", contact_length, 0, 1e6}};
      },
      [&](const DebugStyle& style) {
        DebugDrawer drawer(style);
        drawer.drawLine(btVector3(0, 0, 0), btVector3(1, 1, 1), btVector3(1, 0, 0));
        drawer.drawContactPoint(btVector3(0, 0, 0), btVector3(0, 1, 0), 0, 1, btVector3(1, 1, 0));
        renderer.begin({});
        drawer.draw(renderer);
        return is_whole(renderer.finish(), 32, 24);
      });
}

TEST(EveryField, OfAVideo) {
  if (!video_available()) GTEST_SKIP() << "there is no ffmpeg";
  TemporaryFolder folder;
  struct Video {
    int width = 32, height = 16;
    VideoSettings settings;
  };
  expect_every_field<Video>(
      {},
      [](Video& video) {
        auto& [frames_per_second, quality, program] = video.settings;
        static_assert(std::is_same_v<decltype(program), std::string>);  // video_test.cpp
        return Fields{{"width", video.width, 16, 8192},
                      {"height", video.height, 16, 8192},
                      {"frames_per_second", frames_per_second, 1, 1000},
                      {"quality", quality, 0, 51}};
      },
      [&](const Video& video) {
        VideoWriter writer(folder.file("film.mp4"), video.width, video.height, video.settings);
        writer.add(Image(video.width, video.height));
        writer.close();
        return writer.frame_count() == 1;
      });
}

TEST(EveryField, OfAMeshToDraw) {
  Renderer renderer(plain_settings(32, 24));
  struct Mesh {
    std::vector<Vec3> vertices{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    std::vector<Triangle> triangles{{0, 1, 2}};
    double crease = 40;
  };
  expect_every_field<Mesh>(
      {},
      [](Mesh& mesh) {
        Fields fields{{"crease_degrees", mesh.crease, 0, 180}};
        for (Vec3& v : mesh.vertices)
          add_fields(fields, "vertex", v, -kMaxMeshCoordinate, kMaxMeshCoordinate);
        for (int& v : mesh.triangles[0]) fields.emplace_back("vertex", v, 0, 2);
        return fields;
      },
      [&](const Mesh& given) {
        const int mesh = renderer.add_mesh(given.vertices, given.triangles, given.crease);
        renderer.begin({});
        renderer.draw_mesh(mesh);
        const Image image = renderer.finish();
        renderer.remove_mesh(mesh);
        return is_whole(image, 32, 24);
      });
}

// What is drawn frame by frame never throws for a number: it is left out and counted.
TEST(EveryField, OfADrawCallIsLeftOutAndCounted) {
  Renderer renderer(plain_settings(32, 24));
  const TriangleMesh ball = sphere(0.5, 1);
  const int mesh = renderer.add_mesh(ball.vertices, ball.triangles);
  const float bad_channel = std::numeric_limits<float>::quiet_NaN();
  const Color fine{1, 0, 0}, bad_color{bad_channel, 0, 0};
  for (const double bad : {kNotANumber, kUnbounded, -kUnbounded, 1e300, -1e300}) {
    const Vec3 place(0, bad, 0), good(0, 0, 0);
    Pose pose;
    pose.origin = place;
    renderer.begin({});
    renderer.draw_mesh(mesh, {}, pose);
    renderer.draw_ground({0, 1, 0}, bad);
    renderer.draw_ground({0, 1, 0}, 0, bad_color);
    renderer.draw_line(place, good, fine);
    renderer.draw_line(good, place, fine);
    renderer.draw_line(good, good, bad_color);
    renderer.draw_line(good, {1, 1, 1}, fine, bad);
    renderer.draw_point(place, fine);
    renderer.draw_point(good, bad_color);
    renderer.draw_point(good, fine, bad);
    renderer.draw_triangle(good, place, good, fine);
    renderer.draw_triangle(good, good, good, bad_color);
    renderer.draw_arrow(place, {0, 1, 0}, fine, 0.1);
    renderer.draw_arrow(good, place, fine, 0.1);
    renderer.draw_arrow(good, {0, 1, 0}, fine, bad);
    renderer.draw_text(bad, 0, "text");
    renderer.draw_label(place, "text");
    const Image image = renderer.finish();
    EXPECT_EQ(renderer.stats().skipped_not_finite, 17) << bad;
    EXPECT_EQ(count_drawn(image), 0) << bad;
  }
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
