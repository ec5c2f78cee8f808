// What a cloth is cut from.
#include <algorithm>
#include <cmath>

#include "scene_cloth_parts.h"
#include "scene_limits.h"
#include "scene_mesh.h"
#include "softpoint/core/error.h"
#include "softpoint/core/obj.h"
#include "softpoint/core/shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr int kMostPoints = 1000;   // of a sheet along a side
constexpr double kMostBump = 10.0;  // m

struct Bump {
  double x = 0, z = 0;  // m
  double radius = 0;    // m
  double height = 0;    // m
};

// Slack cut into a sheet: it stands off its plane without being stretched.
void cut_bumps(cloth::ClothPattern& pattern, const std::vector<Bump>& bumps) {
  if (bumps.empty()) return;
  for (Vec3& x : pattern.points) {
    for (const Bump& bump : bumps) {
      const double share =
          1 - (std::pow(x.x() - bump.x, 2) + std::pow(x.z() - bump.z, 2)) / std::pow(bump.radius, 2);
      if (share > 0) x.y() += bump.height * share * share;
    }
  }
  for (cloth::Spring& spring : pattern.springs) {
    spring.rest = (pattern.points[static_cast<std::size_t>(spring.a)] -
                   pattern.points[static_cast<std::size_t>(spring.b)])
                      .norm();
  }
}

using MakePattern = std::function<cloth::ClothPattern(const cloth::Fabric&)>;

MakePattern read_sheet(ObjectReader& reader) {
  const std::vector<double> points =
      reader.numbers("points", {.low = 2, .high = kMostPoints},
                     {.min = 2, .max = 2, .optional = true, .doc = "along x (warp) and z (weft); [50, 50]"});
  for (const double n : points) {
    if (n != std::floor(n) && !reader.describing()) reader.refuse("points", "permitted are whole numbers");
  }
  const std::vector<double> size =
      reader.numbers("size", {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength},
                     {.min = 2, .max = 2, .optional = true, .doc = "along x and z; [0.3, 0.3]"});
  const auto lumping = reader.choice<cloth::Lumping>(
      "lumping", {{"area", cloth::Lumping::kArea}, {"equal", cloth::Lumping::kEqual}},
      {.fallback = "area", .doc = "how points get their mass; equal: all the same, as in the thesis"});
  std::vector<Bump> bumps;
  reader.list(
      "bumps", {.optional = true, .doc = "slack that stands off the sheet and makes bubbles"},
      [&](ObjectReader& item, int) {
        Bump bump;
        const Vec3 at = item.vec3("at", {.quantity = Quantity::kLength,
                                         .low = -kMaxLength,
                                         .high = kMaxLength,
                                         .doc = "of its middle on the sheet; y does not count"});
        bump.x = at.x();
        bump.z = at.z();
        bump.radius = length(item, "radius");
        bump.height = item.number(
            "height",
            {.quantity = Quantity::kLength, .low = -kMostBump, .high = kMostBump, .doc = "over the sheet"});
        bumps.push_back(bump);
      });
  const int columns = points.empty() ? 50 : static_cast<int>(points[0]);
  const int rows = points.empty() ? 50 : static_cast<int>(points[1]);
  const double width = size.empty() ? 0.3 : size[0], depth = size.empty() ? 0.3 : size[1];
  return [=](const cloth::Fabric& fabric) {
    cloth::ClothPattern pattern = cloth::square_pattern(columns, rows, width, depth, fabric, lumping);
    for (Vec3& x : pattern.points) x = Vec3(x.x(), x.z(), -x.y());  // from z up to y up
    cut_bumps(pattern, bumps);
    return pattern;
  };
}

MakePattern read_ball(ObjectReader& reader) {
  const double radius = length(reader, "radius");
  const int subdivisions = reader.integer(
      "subdivisions",
      {.low = 0, .high = 6, .fallback = 3, .doc = "of an icosahedron: 12, 42, 162, 642 ... points"});
  return
      [=](const cloth::Fabric& fabric) { return cloth::mesh_pattern(sphere(radius, subdivisions), fabric); };
}

MakePattern read_surface(ObjectReader& reader) {
  const auto file =
      reader.file("file", {.doc = "OBJ, metres, open or closed; polygons count as fans of triangles"});
  const double scale = reader.number(
      "scale", {.low = 1.0 / kMaxScale, .high = kMaxScale, .fallback = 1.0, .doc = "factor on all lengths"});
  return [=](const cloth::Fabric& fabric) {
    return cloth::mesh_pattern(transformed(read_obj(file), scale * Mat3::Identity(), Vec3::Zero()), fabric);
  };
}

}  // namespace

cloth::ClothPattern read_pattern(ObjectReader& item, const cloth::Fabric& fabric) {
  cloth::ClothPattern pattern;
  item.object("pattern", "what the cloth is cut from, its middle at the body's position",
              [&](ObjectReader& reader) {
                const auto keep = [&](MakePattern (*read)(ObjectReader&)) {
                  return [&pattern, &fabric, read](ObjectReader& shape) {
                    const MakePattern make = read(shape);
                    if (shape.describing()) return;
                    try {
                      pattern = make(fabric);
                    } catch (const Error& error) {
                      shape.refuse(error.what());
                    }
                  };
                };
                reader.variant("kind",
                               {{"square", "a flat sheet in the x-z plane that faces up", keep(read_sheet)},
                                {"sphere", "a closed ball, which holds its own air", keep(read_ball)},
                                {"obj", "any surface from a file", keep(read_surface)}},
                               {});
              });
  return pattern;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
