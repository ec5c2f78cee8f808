#include "softpoint/picture/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer_impl.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// Pixel positions beyond this would not fit an int and show nothing anyway.
constexpr double kFarOffPicture = 1e6;
constexpr double kMaxPixels = 1e4;  // of a line's width, a point's radius

bool within(const Vec3& place) { return place.allFinite() && place.cwiseAbs().maxCoeff() <= kFarthest; }

bool finite(Color color) { return std::isfinite(color.r + color.g + color.b + color.a); }

bool permitted_pixels(double pixels) { return pixels >= 0 && pixels <= kMaxPixels; }

}  // namespace

void check(const RenderSettings& settings) {
  check_range("width", settings.width, 16, 8192);
  check_range("height", settings.height, 16, 8192);
  if (settings.samples != 1 && settings.samples != 4) {
    throw Error("samples = " + std::to_string(settings.samples) + ": permitted is 1 or 4");
  }
  check_range("shadow_resolution", settings.shadow_resolution, 64, 8192);
  check_range("shadow_softness", settings.shadow_softness, 0.0, 0.1);
  check_range("light_azimuth_degrees", settings.light_azimuth_degrees, -360.0, 360.0);
  check_range("light_elevation_degrees", settings.light_elevation_degrees, 5.0, 90.0);
  if (settings.grid_spacing != 0.0 && !(settings.grid_spacing >= 1e-6 && settings.grid_spacing <= 1e9)) {
    throw Error("grid_spacing = " + to_text(settings.grid_spacing) + ": permitted is 0, or 1e-06 to 1e+09");
  }
  check(settings.background, "background");
}

Renderer::Renderer(const RenderSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}

Renderer::~Renderer() = default;

int Renderer::add_mesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                       double crease_degrees) {
  return impl_->meshes.add(SmoothMesh(vertices, triangles, crease_degrees));
}

void Renderer::update_mesh(int mesh, std::span<const Vec3> vertices) { impl_->meshes.move(mesh, vertices); }

void Renderer::remove_mesh(int mesh) { impl_->meshes.remove(mesh); }

void Renderer::begin(const Camera& camera) { impl_->begin(camera); }

void Renderer::draw_mesh(int mesh, const Material& material, const Pose& pose) {
  impl_->require_frame("draw_mesh");
  check(material);
  impl_->add_mesh_draw(mesh, material, pose);
}

void Renderer::draw_ground(const Vec3& normal, double offset, Color color) {
  impl_->require_frame("draw_ground");
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length) || !(std::abs(offset / length) <= kFarthest) ||
      !finite(color)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  impl_->grounds.push_back({normal / length, offset / length, color});
}

void Renderer::draw_line(const Vec3& from, const Vec3& to, Color color, double width_pixels,
                         bool see_through) {
  impl_->require_frame("draw_line");
  if (!within(from) || !within(to) || !finite(color) || !permitted_pixels(width_pixels)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  impl_->overlay.add_line(from - impl_->view.eye, to - impl_->view.eye, color, width_pixels, see_through);
}

void Renderer::draw_point(const Vec3& center, Color color, double radius_pixels, bool see_through) {
  impl_->require_frame("draw_point");
  if (!within(center) || !finite(color) || !permitted_pixels(radius_pixels)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  impl_->overlay.add_point(center - impl_->view.eye, color, radius_pixels, see_through);
}

void Renderer::draw_triangle(const Vec3& a, const Vec3& b, const Vec3& c, Color color) {
  impl_->require_frame("draw_triangle");
  if (!within(a) || !within(b) || !within(c) || !finite(color)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  const Vec3& eye = impl_->view.eye;
  impl_->overlay.add_triangle(a - eye, b - eye, c - eye, color);
}

void Renderer::draw_arrow(const Vec3& from, const Vec3& vector, Color color, double radius) {
  impl_->require_frame("draw_arrow");
  const double length = vector.norm();
  if (!(length <= kFarthest) || !within(from) || !(std::abs(radius) <= kFarthest) || !finite(color)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  if (length == 0 || radius <= 0) return;
  Material material;
  material.color = color;
  material.roughness = 0.45;
  material.casts_shadow = false;
  const Vec3 axis = vector / length;
  const std::array<Vec3, 2> across = tangents(axis);
  const double head = std::min(6.0 * radius, 0.5 * length);
  const double head_radius = 2.4 * radius * head / (6.0 * radius);
  const double shaft_radius = std::min(radius, 0.6 * head_radius);
  // The unit shapes reach from -1 to 1 along their y axis.
  const auto place = [&](int mesh, double begin, double end, double thickness) {
    Pose pose;
    pose.linear.col(0) = across[1] * thickness;
    pose.linear.col(1) = axis * (0.5 * (end - begin));
    pose.linear.col(2) = across[0] * thickness;
    pose.origin = from + axis * (0.5 * (begin + end));
    impl_->add_mesh_draw(mesh, material, pose);
  };
  place(impl_->arrow_shaft, 0.0, length - head, shaft_radius);
  place(impl_->arrow_head, length - head, length, head_radius);
}

void Renderer::draw_text(double x, double y, std::string_view text, const TextStyle& style) {
  impl_->require_frame("draw_text");
  check(style);
  if (!(std::abs(x) < kFarOffPicture && std::abs(y) < kFarOffPicture)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  impl_->add_text(x, y, text, style);
}

void Renderer::draw_label(const Vec3& anchor, std::string_view text, const TextStyle& style) {
  impl_->require_frame("draw_label");
  check(style);
  if (!within(anchor)) {
    ++impl_->stats.skipped_not_finite;
    return;
  }
  const Projected at = project(impl_->camera, impl_->settings.width, impl_->settings.height, anchor);
  if (at.depth <= 0 || !(std::abs(at.x) < kFarOffPicture && std::abs(at.y) < kFarOffPicture)) return;
  impl_->add_text(at.x + 6, at.y - 0.5 * measure_text(text, style).height, text, style);
}

void Renderer::finish(Image& image) { impl_->finish(image); }

Image Renderer::finish() {
  Image image;
  impl_->finish(image);
  return image;
}

bool Renderer::concerns_frame(const Vec3& low, const Vec3& high) const {
  Box box;
  box.center = 0.5 * (low + high);
  for (int c = 0; c < 3; ++c) box.half[static_cast<std::size_t>(c)] = Vec3::Unit(c) * (0.5 * (high - low)[c]);
  return impl_->view.sees(box) || (impl_->settings.shadows && impl_->view.sees_shadow(box, -impl_->to_light));
}

const RenderSettings& Renderer::settings() const { return impl_->settings; }
const Camera& Renderer::camera() const { return impl_->camera; }
const RenderStats& Renderer::stats() const { return impl_->last_stats; }
const std::string& Renderer::driver() const { return impl_->driver; }
Backend Renderer::backend() const { return impl_->context->backend(); }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
