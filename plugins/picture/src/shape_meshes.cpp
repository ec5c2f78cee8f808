#include "shape_meshes.h"

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include <algorithm>

#include "bullet_vec.h"
#include "shape_triangles.h"
#include "shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr std::uint64_t kShapeFramesKept = 128;

// Turns the y axis, round which our shapes are built, to coordinate axis 0, 1 or 2.
Mat3 y_to_axis(int axis) {
  Mat3 turn = Mat3::Zero();
  turn.col(1) = Vec3::Unit(axis);
  turn.col(2) = Vec3::Unit((axis + 1) % 3);
  turn.col(0) = Vec3::Unit((axis + 2) % 3);
  return turn;
}

}  // namespace

ShapeMeshes::~ShapeMeshes() {
  for (const int mesh : units_) {
    if (mesh >= 0) renderer_.remove_mesh(mesh);
  }
  for (const auto& [ratio, capsule] : capsules_) renderer_.remove_mesh(capsule.mesh);
  for (const auto& [shape, own] : own_) {
    if (own.mesh >= 0) renderer_.remove_mesh(own.mesh);
  }
}

int ShapeMeshes::add(const TriangleMesh& mesh) {
  ++tessellated_;
  const bool drawable = !mesh.triangles.empty() && std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                                               [](const Vec3& p) { return p.allFinite(); });
  return drawable ? renderer_.add_mesh(mesh.vertices, mesh.triangles) : -1;
}

int ShapeMeshes::unit(Unit which) {
  int& mesh = units_[which];
  if (mesh >= 0) return mesh;
  switch (which) {
    case kBox:
      return mesh = add(unit_box());
    case kSphere:
      return mesh = add(unit_sphere(40, 24));
    case kCylinder:
      return mesh = add(unit_cylinder(40));
    default:
      return mesh = add(unit_cone(40));
  }
}

int ShapeMeshes::capsule_mesh(double half_length_over_radius) {
  const auto [found, is_new] = capsules_.try_emplace(half_length_over_radius);
  if (is_new) found->second.mesh = add(picture::capsule(1.0, half_length_over_radius, 32, 18));
  found->second.used = frame_;
  return found->second.mesh;
}

ShapeMeshes::Signature ShapeMeshes::sign(const btCollisionShape& shape) {
  Signature signature;
  signature.type = shape.getShapeType();
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const btVector3 scaling = shape.getLocalScaling();
  signature.numbers[0] = shape.getMargin();
  for (std::size_t c = 0; c < 3; ++c) {
    signature.numbers[1 + c] = scaling[static_cast<int>(c)];
    signature.numbers[4 + c] = low[static_cast<int>(c)];
    signature.numbers[7 + c] = high[static_cast<int>(c)];
  }
  return signature;
}

ShapeMesh ShapeMeshes::own_mesh(const btCollisionShape& shape) {
  const Signature signature = sign(shape);
  const auto [found, is_new] = own_.try_emplace(&shape);
  Own& own = found->second;
  if (is_new || own.signature != signature) {
    if (own.mesh >= 0) renderer_.remove_mesh(own.mesh);
    own.signature = signature;
    own.open_surface = shape.isConcave();
    own.mesh = shape.isConvex()    ? add(convex_triangles(static_cast<const btConvexShape&>(shape)))
               : shape.isConcave() ? add(concave_triangles(static_cast<const btConcaveShape&>(shape)))
                                   : -1;
  }
  own.used = frame_;
  return {own.mesh, Mat3::Identity(), own.open_surface};
}

ShapeMesh ShapeMeshes::find(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE: {
      const Vec3 half = to_vec3(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin()).cwiseAbs();
      return {unit(kBox), Mat3(half.asDiagonal()), false};
    }
    case SPHERE_SHAPE_PROXYTYPE: {
      const double radius = static_cast<const btSphereShape&>(shape).getRadius();
      return {unit(kSphere), Mat3::Identity() * radius, false};
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const Vec3 half = to_vec3(cylinder.getHalfExtentsWithMargin()).cwiseAbs();
      return {unit(kCylinder), half.asDiagonal() * y_to_axis(cylinder.getUpAxis()), false};
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      const Vec3 half(cone.getRadius(), 0.5 * cone.getHeight(), cone.getRadius());
      return {unit(kCone), y_to_axis(cone.getConeUpIndex()) * half.asDiagonal(), false};
    }
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      const double radius = capsule.getRadius();
      if (!(radius > 0)) return {};
      return {capsule_mesh(capsule.getHalfHeight() / radius), y_to_axis(capsule.getUpAxis()) * radius, false};
    }
    default:
      return own_mesh(shape);
  }
}

void ShapeMeshes::end_frame() {
  if (++frame_ % kShapeFramesKept != 0) return;
  const auto unused = [this](std::uint64_t used) { return used + kShapeFramesKept < frame_; };
  std::erase_if(capsules_, [&](const auto& entry) {
    if (!unused(entry.second.used)) return false;
    renderer_.remove_mesh(entry.second.mesh);
    return true;
  });
  std::erase_if(own_, [&](const auto& entry) {
    if (!unused(entry.second.used)) return false;
    if (entry.second.mesh >= 0) renderer_.remove_mesh(entry.second.mesh);
    return true;
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
