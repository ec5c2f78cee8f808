#include "scene_rigid_reader.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "scene_limits.h"
#include "softpoint/core/error.h"
#include "softpoint/core/obj.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

Mat3 read_rotation(ObjectReader& item) {
  const bool by_axis = item.has("axis") || item.has("angle");
  const bool by_euler = item.has("euler"), by_quaternion = item.has("quaternion");
  if (!item.describing() && by_axis + by_euler + by_quaternion != 1) {
    item.refuse("permitted is one of: axis and angle, euler, quaternion");
  }
  Mat3 rotation = Mat3::Identity();
  if (by_axis || item.describing()) {
    const Vec3 axis = item.vec3(
        "axis",
        {.low = -kMaxDirection, .high = kMaxDirection, .doc = "need not be a unit vector; with angle"});
    const double angle = item.number("angle", {.quantity = Quantity::kAngle,
                                               .low = -kMaxAngle,
                                               .high = kMaxAngle,
                                               .doc = "right-handed; with axis"});
    if (axis.norm() < 1e-9) {
      item.refuse("axis", "permitted is any direction but zero");
    }
    rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  }
  if (by_euler || item.describing()) {
    const Vec3 e = item.vec3("euler", {.quantity = Quantity::kAngle,
                                       .low = -kMaxAngle,
                                       .high = kMaxAngle,
                                       .doc = "turn about the world's x, then its y, then its z axis"});
    rotation = (Eigen::AngleAxisd(e.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(e.y(), Vec3::UnitY()) *
                Eigen::AngleAxisd(e.x(), Vec3::UnitX()))
                   .toRotationMatrix();
  }
  if (by_quaternion || item.describing()) {
    const auto q = item.numbers("quaternion", {.low = -kMaxDirection, .high = kMaxDirection},
                                {.min = 4, .max = 4, .doc = "[x, y, z, w], any length but 0"});
    if (!item.describing()) {
      const Eigen::Quaterniond quaternion(q[3], q[0], q[1], q[2]);
      if (quaternion.norm() < 1e-9) {
        item.refuse("quaternion", "permitted is any but zero");
      }
      rotation = quaternion.normalized().toRotationMatrix();
    }
  }
  return rotation;
}

int read_axis(ObjectReader& item) {
  return item.choice("axis", {"x", "y", "z"}, {.fallback = "y", .doc = "along which the shape lies"});
}

ReadObject round_shape(ShapeSpec& shape, ShapeKind kind, const std::string& length_doc) {
  return [&shape, kind, length_doc](ObjectReader& item) {
    shape.kind = kind;
    shape.radius = length(item, "radius");
    shape.length = length(item, "length", length_doc);
    shape.axis = read_axis(item);
  };
}

void read_surface(ObjectReader& item, ShapeSpec& shape, ShapeKind kind) {
  shape.kind = kind;
  const bool mesh = kind == ShapeKind::kMesh;
  const auto file = item.file("file", {.doc = mesh ? "OBJ, metres; its triangles, touched on both sides"
                                                   : "OBJ, metres; the convex hull of its vertices"});
  const double scale = item.number(
      "scale", {.low = 1.0 / kMaxScale, .high = kMaxScale, .fallback = 1.0, .doc = "factor on all lengths"});
  if (item.describing()) {
    return;
  }
  try {
    TriangleMesh surface = read_obj(file);
    for (const Vec3& vertex : surface.vertices) {
      shape.points.push_back(scale * vertex);
    }
    if (mesh) {
      shape.triangles = std::move(surface.triangles);
    }
  } catch (const Error& error) {
    item.refuse("file", error.what());
  }
}

void read_shape(ObjectReader& item, ShapeSpec& shape, bool may_be_compound);

void read_compound(ObjectReader& item, ShapeSpec& shape) {
  shape.kind = ShapeKind::kCompound;
  item.list("parts", {.min = 1, .max = 1000, .doc = "convex shapes, placed in the body's frame"},
            [&](ObjectReader& part_reader, int) {
              ShapePart part;
              read_shape(part_reader, part.shape, false);
              part.placement = read_placement(part_reader);
              shape.parts.push_back(std::move(part));
            });
}

void read_shape(ObjectReader& item, ShapeSpec& shape, bool may_be_compound) {
  std::vector<Variant> variants = {
      {"box", "",
       [&](ObjectReader& reader) {
         shape.kind = ShapeKind::kBox;
         shape.size = reader.vec3(
             "size",
             {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength, .doc = "whole edges"});
       }},
      {"sphere", "",
       [&](ObjectReader& reader) {
         shape.kind = ShapeKind::kSphere;
         shape.radius = length(reader, "radius");
       }},
      {"capsule", "", round_shape(shape, ShapeKind::kCapsule, "without the half spheres")},
      {"cylinder", "", round_shape(shape, ShapeKind::kCylinder, "")},
      {"cone", "tip towards the positive axis", round_shape(shape, ShapeKind::kCone, "tip to base")},
      {"hull", "convex hull", [&](ObjectReader& reader) { read_surface(reader, shape, ShapeKind::kHull); }},
  };
  if (may_be_compound) {
    variants.push_back({"plane", "all below normal . x = offset; never moves", [&](ObjectReader& reader) {
                          shape.kind = ShapeKind::kPlane;
                          shape.normal = reader.vec3("normal", {.low = -kMaxDirection,
                                                                .high = kMaxDirection,
                                                                .fallback = Vec3(0.0, 1.0, 0.0),
                                                                .doc = "need not be a unit vector"});
                          if (shape.normal.norm() < 1e-9) {
                            reader.refuse("normal", "permitted is any direction but zero");
                          }
                          shape.normal.normalize();
                          shape.offset = reader.number(
                              "offset", {.quantity = Quantity::kLength,
                                         .low = -kMaxPlace,
                                         .high = kMaxPlace,
                                         .fallback = 0.0,
                                         .doc = "from the body's position along the unit normal"});
                        }});
    variants.push_back({"mesh", "any surface, closed or open; never moves",
                        [&](ObjectReader& reader) { read_surface(reader, shape, ShapeKind::kMesh); }});
    variants.push_back(
        {"compound", "rigidly joined", [&](ObjectReader& reader) { read_compound(reader, shape); }});
  }
  item.variant("shape", variants, {});
}

double share(ObjectReader& item, std::string_view key, double fallback, double high, const std::string& doc) {
  return item.number(key, {.low = 0.0, .high = high, .fallback = fallback, .doc = doc});
}

}  // namespace

Placement read_placement(ObjectReader& item) {
  Placement placement;
  placement.position = item.vec3(
      "position",
      {.quantity = Quantity::kLength, .low = -kMaxPlace, .high = kMaxPlace, .fallback = Vec3(0.0, 0.0, 0.0)});
  item.optional_object("orientation", "turned before it is moved to its position; one of the three forms",
                       [&](ObjectReader& reader) { placement.rotation = read_rotation(reader); });
  return placement;
}

Motion read_motion(ObjectReader& item) {
  Motion motion;
  motion.linear = item.vec3("velocity", {.quantity = Quantity::kVelocity,
                                         .low = -kMaxSpeed,
                                         .high = kMaxSpeed,
                                         .fallback = Vec3(0.0, 0.0, 0.0),
                                         .doc = "of the centre of mass"});
  motion.angular = item.vec3("angular_velocity", {.quantity = Quantity::kAngularVelocity,
                                                  .low = -kMaxSpin,
                                                  .high = kMaxSpin,
                                                  .fallback = Vec3(0.0, 0.0, 0.0)});
  return motion;
}

std::optional<Rgb> read_color(ObjectReader& item) {
  return item.optional_vec3("color", {.low = 0.0, .high = 1.0, .doc = "red, green, blue (sRGB)"});
}

RigidBodySpec read_rigid_body(ObjectReader& item) {
  RigidBodySpec body;
  body.name = item.text("name", {.fallback = "", .doc = "unique; for events and results"});
  read_shape(item, body.shape, true);
  body.mass = item.number("mass", {.quantity = Quantity::kMass,
                                   .low = 0.0,
                                   .high = kMaxMass,
                                   .fallback = 0.0,
                                   .doc = "0: never moves; else 1e-9 kg or more"});
  body.placement = read_placement(item);
  body.motion = read_motion(item);
  body.friction = share(item, "friction", 0.5, 100.0, "coefficient; the product of both bodies' counts");
  body.restitution = share(item, "restitution", 0.0, 1.0, "the product of both bodies' counts");
  body.rolling_friction =
      share(item, "rolling_friction", 0.0, 100.0, "Bullet's coefficient, among rigid bodies");
  body.linear_damping = share(item, "linear_damping", 0.0, 1.0, "share of the speed lost in a second");
  body.angular_damping = share(item, "angular_damping", 0.0, 1.0, "share of the spin lost in a second");
  body.may_sleep = item.boolean("may_sleep", {.fallback = true, .doc = "Bullet may stop it when it is slow"});
  body.visible = item.boolean("visible", {.fallback = true, .doc = "in pictures"});
  body.color = read_color(item);
  if (!item.describing()) {
    if (body.mass > 0.0 && body.mass < kMinMass) {
      item.refuse("mass",
                  fmt::format("permitted is 0, or {} to {} kg", to_text(kMinMass), to_text(kMaxMass)));
    }
    if (body.shape.kind == ShapeKind::kPlane && body.mass > 0.0) {
      item.refuse("mass", "a plane never moves; permitted is 0");
    }
    if (body.shape.kind == ShapeKind::kMesh && body.mass > 0.0) {
      item.refuse("mass", "a mesh never moves; permitted is 0, or the shape hull");
    }
    if (body.mass == 0.0 && !(body.motion.linear.isZero(0.0) && body.motion.angular.isZero(0.0))) {
      item.refuse("a body of mass 0 never moves; permitted is no velocity, or a mass above 0 kg");
    }
  }
  return body;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
