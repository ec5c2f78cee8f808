#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "softpoint/core/vec.h"
#include "softpoint/picture/backend.h"
#include "softpoint/picture/camera.h"
#include "softpoint/picture/image.h"
#include "softpoint/picture/material.h"
#include "softpoint/picture/text.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// What all frames of a renderer have in common.
struct RenderSettings {
  Backend backend = Backend::kAuto;  // what lends the OpenGL context

  int width = 1280;  // pixels, 16 to 8192
  int height = 720;  // pixels, 16 to 8192
  int samples = 4;   // per pixel: 1 or 4

  bool shadows = true;             // of the one light
  int shadow_resolution = 1024;    // texels a side, 64 to 8192
  double shadow_softness = 0.006;  // half width of the penumbra over the lit scene's extent, 0 to 0.1

  // Where the light comes from, seen against the camera's world up.
  double light_azimuth_degrees = 60.0;    // -360 to 360
  double light_elevation_degrees = 52.0;  // 5 to 90

  bool grid = true;         // lines on the ground
  double grid_spacing = 0;  // metres between lines, 1e-6 to 1e9; 0: a power of ten by the camera's distance

  bool sky = true;                        // else the plain `background`
  Color background{0.93F, 0.94F, 0.95F};  // opaque
};

// x -> linear x + origin. Metres; `linear` may rotate, scale and shear, but not mirror.
struct Pose {
  Mat3 linear = Mat3::Identity();  // no unit
  Vec3 origin{0.0, 0.0, 0.0};      // metres
};

// What the last frame took.
struct RenderStats {
  int meshes_drawn = 0;           // within the camera's field of view
  int meshes_culled = 0;          // outside of it
  int casters_drawn = 0;          // into the shadow map
  int casters_culled = 0;         // without a shadow in the picture
  long long triangles_drawn = 0;  // of meshes, by the camera
  int meshes_uploaded = 0;        // new or moved since they were last drawn
  int skipped_not_finite = 0;     // draw calls dropped for a NaN, or places beyond kFarthest
};

// Draws off screen, frame by frame: begin(), any draw_...(), finish(). All coordinates are metres in the
// world frame. Nothing allocates once frames of the same size repeat. One Renderer belongs to one thread at a
// time; several may live side by side, also of different backends. finish(), constructor and destructor leave
// no OpenGL context current on the calling thread: an application with one of its own makes that current
// again.
//
// Errors: wrong settings, cameras, materials, styles, indices and calls out of turn throw Error; what cannot
// be drawn for a NaN, infinity or place beyond kFarthest is left out and counted.
class SOFTPOINT_API Renderer {
 public:
  // Makes an OpenGL context of its own. Throws Error also when no backend gives one, naming those tried and
  // the reason of each.
  explicit Renderer(const RenderSettings& settings = {});
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;
  ~Renderer();

  // Keeps a surface for draw_mesh(). Edges whose faces meet at more than `crease_degrees` are drawn sharp,
  // the others are shaded smoothly. The faces of a mesh stay; its vertices may be moved by update_mesh().
  // The number returned is the mesh's until remove_mesh(), after which it may be given to another.
  int add_mesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
               double crease_degrees = 40.0);
  // Same count and order of vertices as in add_mesh(); uploaded only if the mesh is drawn.
  void update_mesh(int mesh, std::span<const Vec3> vertices);
  // What the frame begun has drawn of it already still shows.
  void remove_mesh(int mesh);

  // Opens a frame.
  void begin(const Camera& camera);
  // A mesh of add_mesh(), moved by `pose`.
  void draw_mesh(int mesh, const Material& material = {}, const Pose& pose = {});
  // The unbounded plane normal . x = offset, seen from above only. `normal` need not be a unit vector.
  void draw_ground(const Vec3& normal = {0.0, 1.0, 0.0}, double offset = 0.0, Color color = kGroundColor);
  // Lines, points and flat triangles are not lit. With `see_through` they also show behind other things.
  void draw_line(const Vec3& from, const Vec3& to, Color color, double width_pixels = 1.5,
                 bool see_through = false);
  // A round point of fixed size in the picture.
  void draw_point(const Vec3& center, Color color, double radius_pixels = 4.0, bool see_through = false);
  // Flat, seen from both sides.
  void draw_triangle(const Vec3& a, const Vec3& b, const Vec3& c, Color color);
  // A shaded arrow from `from` to `from + vector`, its shaft `radius` metres thick.
  void draw_arrow(const Vec3& from, const Vec3& vector, Color color, double radius);
  // Text over the picture, its top left corner in pixels; or beside a point of the scene.
  void draw_text(double x, double y, std::string_view text, const TextStyle& style = {});
  // Text beside `anchor` (metres).
  void draw_label(const Vec3& anchor, std::string_view text, const TextStyle& style = {});
  // Renders the frame. The first form reuses the memory of `image`.
  void finish(Image& image);
  // Renders the frame into an image of its own.
  Image finish();

  // Would a thing within this box (world axes) show in the frame begun, or throw a shadow that may show?
  bool concerns_frame(const Vec3& low, const Vec3& high) const;

  const RenderSettings& settings() const;  // of the constructor
  const Camera& camera() const;            // of begin()
  const RenderStats& stats() const;        // of the last finished frame
  // The driver's own words, e.g. to key golden pictures: "llvmpipe (...), 4.5 (Core Profile) Mesa 22.3.6".
  const std::string& driver() const;
  // What lends the OpenGL context; never kAuto.
  Backend backend() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
