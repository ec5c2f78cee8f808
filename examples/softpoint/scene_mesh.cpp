#include "scene_mesh.h"

#include <functional>
#include <utility>

#include "scene_limits.h"
#include "softpoint/core/error.h"
#include "softpoint/core/obj.h"
#include "softpoint/core/shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

// What the reader of a kind gives: made once the document is known to be there.
using MakeMesh = std::function<TriangleMesh()>;

int count(ObjectReader& reader, std::string_view key, int low, int fallback, const std::string& doc) {
  return reader.integer(key, {.low = low, .high = 1000, .fallback = fallback, .doc = doc});
}

MakeMesh read_sphere(ObjectReader& reader) {
  const double radius = length(reader, "radius");
  const int subdivisions = reader.integer(
      "subdivisions",
      {.low = 0, .high = 6, .fallback = 2, .doc = "of an icosahedron: 12, 42, 162 ... vertices"});
  return [=] { return sphere(radius, subdivisions); };
}

MakeMesh read_box(ObjectReader& reader) {
  const Vec3 size = reader.vec3(
      "size", {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength, .doc = "whole edges"});
  const auto cells =
      reader.numbers("cells", {.low = 1, .high = 200},
                     {.min = 3, .max = 3, .optional = true, .doc = "along x, y, z; [3, 3, 3]"});
  if (cells.empty()) {
    return [=] { return box_grid(3, 3, 3, size); };
  }
  for (const double n : cells) {
    if (n != static_cast<int>(n)) {
      reader.refuse("cells", "permitted are whole numbers");
    }
  }
  return [=] {
    return box_grid(static_cast<int>(cells[0]), static_cast<int>(cells[1]), static_cast<int>(cells[2]), size);
  };
}

MakeMesh read_prism(ObjectReader& reader) {
  const int sides = count(reader, "sides", 3, 16, "");
  const int stacks = count(reader, "stacks", 1, 4, "layers of the side");
  const int cap_rings = count(reader, "cap_rings", 1, 1, "rings of each cap");
  const double radius = length(reader, "radius");
  const double height = length(reader, "length", "along z");
  const auto meaning = reader.choice<PrismRadius>(
      "radius_of", {{"corners", PrismRadius::kCircumscribed}, {"equal_area", PrismRadius::kEqualArea}},
      {.fallback = "corners", .doc = "equal_area: the cross-section has the area of the circle"});
  return [=] { return prism(sides, stacks, cap_rings, radius, height, meaning); };
}

MakeMesh read_capsule(ObjectReader& reader) {
  const double radius = length(reader, "radius");
  const double height = length(reader, "length", "of the cylinder, along z, without the half spheres");
  const int sectors = count(reader, "sectors", 3, 16, "round the axis");
  const int stacks = count(reader, "stacks", 1, 4, "layers of the cylinder");
  const int rings = count(reader, "rings", 1, 4, "layers of each half sphere");
  return [=] { return capsule(radius, height, sectors, stacks, rings); };
}

MakeMesh read_hollow_sphere(ObjectReader& reader) {
  const double outer = length(reader, "outer_radius", "");
  const double inner = length(reader, "inner_radius", "of the cavity");
  const int subdivisions =
      reader.integer("subdivisions", {.low = 0, .high = 5, .fallback = 2, .doc = "of an icosahedron"});
  return [=] { return hollow_sphere(outer, inner, subdivisions); };
}

MakeMesh read_obj_mesh(ObjectReader& reader) {
  const auto file = reader.file("file", {.doc = "OBJ, metres; polygons count as fans of triangles"});
  const double scale = reader.number(
      "scale", {.low = 1.0 / kMaxScale, .high = kMaxScale, .fallback = 1.0, .doc = "factor on all lengths"});
  return [=] { return transformed(read_obj(file), scale * Mat3::Identity(), Vec3::Zero()); };
}

}  // namespace

TriangleMesh read_mesh(ObjectReader& item, std::string_view key) {
  TriangleMesh mesh;
  item.object(key, "closed surface of the body, its middle at the body's position",
              [&](ObjectReader& reader) {
                const auto keep = [&](MakeMesh (*read)(ObjectReader&)) {
                  return [&mesh, read](ObjectReader& shape) {
                    const MakeMesh make = read(shape);
                    if (shape.describing()) {
                      return;
                    }
                    try {
                      mesh = make();
                      check_closed(mesh);
                    } catch (const Error& error) {
                      shape.refuse(error.what());
                    }
                  };
                };
                reader.variant("kind",
                               {{"sphere", "icosahedron, split", keep(read_sphere)},
                                {"box", "a grid on each face", keep(read_box)},
                                {"prism", "over a regular polygon", keep(read_prism)},
                                {"capsule", "", keep(read_capsule)},
                                {"hollow_sphere", "with a spherical cavity", keep(read_hollow_sphere)},
                                {"obj", "from a file", keep(read_obj_mesh)}},
                               {});
              });
  return mesh;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
