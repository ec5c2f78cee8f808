#include "ground.h"

#include <cmath>

#include "shaders/ground.h"
#include "shaders/lighting.h"
#include "srgb.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr int kFanSides = 48;

}  // namespace

GroundPainter::GroundPainter(const GlApi& gl)
    : gl_(gl),
      program_(gl, "ground", kGroundVertex, kGroundFragment, kLighting),
      fan_(gl),
      plane_(program_.uniform("plane")),
      axis_u_(program_.uniform("axis_u")),
      axis_v_(program_.uniform("axis_v")),
      paint_(program_.uniform("paint")),
      reach_(program_.uniform("reach")) {
  std::vector<float> disc = {0, 0};
  for (int i = 0; i <= kFanSides; ++i) {
    const double angle = 2 * 3.14159265358979323846 * i / kFanSides;
    disc.push_back(static_cast<float>(std::cos(angle)));
    disc.push_back(static_cast<float>(std::sin(angle)));
  }
  gl.GenVertexArrays(1, &array_);
  gl.BindVertexArray(array_);
  fan_.fill(disc);
  set_attribute(gl, 0, 2, 2 * sizeof(float), 0, 0);
}

void GroundPainter::draw(const View& view, const GroundDraw& ground, double spacing, double radius) const {
  const double height = ground.normal.dot(view.eye) - ground.offset;
  if (height <= 0) return;
  const auto [u, v] = tangents(ground.normal);
  const double period = spacing > 0 ? spacing : 1.0;
  // Ten spacings are the period of the whole pattern: beyond that the eye's place does not matter.
  const auto place = [&](const Vec3& axis) {
    const double cells = axis.dot(view.eye) / period;
    return cells - 10 * std::floor(cells / 10);
  };
  const auto set = [this](GLint location, const Vec3& xyz, double w) {
    const float values[4] = {static_cast<float>(xyz.x()), static_cast<float>(xyz.y()),
                             static_cast<float>(xyz.z()), static_cast<float>(w)};
    gl_.Uniform4fv(location, 1, values);
  };
  program_.use();
  set(plane_, ground.normal, height);
  set(axis_u_, u / period, place(u));
  set(axis_v_, v / period, place(v));
  set(paint_, {decode_srgb(ground.color.r), decode_srgb(ground.color.g), decode_srgb(ground.color.b)},
      spacing > 0 ? 1.0 : 0.0);
  set(reach_, {radius, 0.42 * radius, 0}, 0);
  gl_.BindVertexArray(array_);
  gl_.DrawArrays(GL_TRIANGLE_FAN, 0, kFanSides + 2);
}

double automatic_spacing(const View& view) {
  return std::pow(10.0, std::round(std::log10(view.target_distance / 8.0)));
}

double ground_radius(const View& view, double height) {
  return 25.0 * std::max(view.target_distance, height);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
