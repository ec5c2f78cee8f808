#include "collider_shape.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "nearest_points.h"
#include "shape_features.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Everything a ColliderShape depends on, in nine numbers.
void fingerprint(const btCollisionShape& shape, double (&out)[9]) {
  std::fill(std::begin(out), std::end(out), 0.0);
  out[0] = shape.getShapeType();
  out[1] = shape.getMargin();
  if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
    const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
    const Vec3 n = from_bullet(plane.getPlaneNormal());
    std::copy(n.data(), n.data() + 3, out + 2);
    out[5] = plane.getPlaneConstant();
    return;
  }
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const Vec3 a = from_bullet(low), b = from_bullet(high);
  std::copy(a.data(), a.data() + 3, out + 2);
  std::copy(b.data(), b.data() + 3, out + 5);
  if (shape.isPolyhedral() && shape.getShapeType() != CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
      btVector3 v;
      polyhedron.getVertex(i, v);
      out[8] += (i + 1) * from_bullet(v).dot(Vec3(1.0, 1.7, 2.3));
    }
  }
}

// Points of a polyhedral shape; empty where Bullet cannot tell them.
std::vector<Vec3> points_of(const btCollisionShape& shape) {
  std::vector<Vec3> points;
  if (shape.getShapeType() == CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE) {
    struct Collect final : btInternalTriangleIndexCallback {
      void internalProcessTriangleIndex(btVector3* triangle, int, int) override {
        for (int k = 0; k < 3; ++k) {
          points->push_back(from_bullet(triangle[k] * scaling));
        }
      }
      std::vector<Vec3>* points = nullptr;
      btVector3 scaling;
    } collect;
    const auto& mesh = static_cast<const btConvexTriangleMeshShape&>(shape);
    collect.points = &points;
    collect.scaling = mesh.getLocalScaling();
    const btVector3 all(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
    mesh.getMeshInterface()->InternalProcessAllTriangles(&collect, -all, all);
  } else if (shape.isPolyhedral()) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
      btVector3 v;
      polyhedron.getVertex(i, v);
      points.push_back(from_bullet(v));
    }
  }
  return points;
}

void build_convex(ColliderShape& s, const btConvexShape& shape) {
  const std::vector<Vec3> points = points_of(shape);
  if (points.size() == 3) {  // a lone triangle has two sides and no inside
    ShapeFacet facet{points[0], points[1], points[2],
                     (points[1] - points[0]).cross(points[2] - points[0]).normalized()};
    facet.offset = facet.normal.dot(facet.a);
    s.facets.push_back(facet);
    s.kind = ColliderShape::Kind::mesh;
  } else if (!points.empty()) {
    add_hull_facets(s, points);
    s.kind = ColliderShape::Kind::polyhedron;
  }
  if (s.facets.empty()) {
    s.kind = ColliderShape::Kind::round;
    s.convex = &shape;
  } else {
    add_facet_features(s);
  }
}

ColliderShape build(const btCollisionShape& shape) {
  ColliderShape s;
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  s.bounds_min = from_bullet(low);
  s.bounds_max = from_bullet(high);
  s.thinnest = (s.bounds_max - s.bounds_min).minCoeff();
  switch (shape.getShapeType()) {
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      s.kind = ColliderShape::Kind::plane;
      s.plane_normal = from_bullet(plane.getPlaneNormal()).normalized();
      s.plane_offset = plane.getPlaneConstant();
      s.thinnest = std::numeric_limits<double>::infinity();
      break;
    }
    case SPHERE_SHAPE_PROXYTYPE:
      s.kind = ColliderShape::Kind::sphere;
      s.radius = static_cast<const btSphereShape&>(shape).getRadius();
      break;
    case BOX_SHAPE_PROXYTYPE:
      s.kind = ColliderShape::Kind::box;
      s.half = from_bullet(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
      add_box_features(s);
      break;
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      s.kind = ColliderShape::Kind::capsule;
      s.axis = capsule.getUpAxis();
      s.radius = capsule.getRadius();
      s.half[s.axis] = capsule.getHalfHeight();
      break;
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      s.kind = ColliderShape::Kind::cylinder;
      s.axis = cylinder.getUpAxis();
      s.radius = cylinder.getRadius();
      s.half[s.axis] = from_bullet(cylinder.getHalfExtentsWithMargin())[s.axis];
      add_cylinder_features(s);
      break;
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      s.kind = ColliderShape::Kind::cone;
      s.axis = cone.getConeUpIndex();
      s.radius = cone.getRadius();
      s.half[s.axis] = 0.5 * double(cone.getHeight());
      add_cone_features(s);
      break;
    }
    default:
      if (shape.isConvex()) {
        build_convex(s, static_cast<const btConvexShape&>(shape));
      }
      break;
  }
  return s;
}

SurfaceDistance box_distance(const Vec3& half, const Vec3& p) {
  const Vec3 nearest = p.cwiseMax(-half).cwiseMin(half);
  const Vec3 offset = p - nearest;
  const double outside = offset.norm();
  if (outside > 1e-12) {
    return {outside, offset / outside};
  }
  const Vec3 depth = p.cwiseAbs() - half;  // <= 0
  int axis = 0;
  const double distance = depth.maxCoeff(&axis);
  Vec3 normal = Vec3::Zero();
  normal[axis] = p[axis] < 0 ? -1.0 : 1.0;
  return {distance, normal};
}

SurfaceDistance ball_distance(const Vec3& center, double radius, const Vec3& p, int side) {
  const Vec3 offset = p - center;
  const double length = offset.norm();
  if (length > 1e-12) {
    return {length - radius, offset / length};
  }
  Vec3 normal = Vec3::Zero();
  normal[side] = 1.0;  // at the centre every direction is as good
  return {-radius, normal};
}

// Distance in the half plane (off the axis, along it) of a convex outline that is mirrored at the axis:
// corner a on the axis or not, then b, then c; outward is to the right of a..b..c.
SurfaceDistance turned_distance(const Vec3& p, int axis, std::initializer_list<Eigen::Vector2d> outline) {
  Vec3 off = p;
  off[axis] = 0.0;
  const double rho = off.norm();
  Vec3 radial = Vec3::Zero();
  radial[(axis + 1) % 3] = 1.0;
  if (rho > 1e-12) {
    radial = off / rho;
  }
  const Eigen::Vector2d q(rho, p[axis]);
  double nearest = std::numeric_limits<double>::infinity();
  double behind = -std::numeric_limits<double>::infinity();
  Eigen::Vector2d to_point(0, 1), plane_normal(0, 1);
  for (const Eigen::Vector2d* a = outline.begin(); a + 1 != outline.end(); ++a) {
    const Eigen::Vector2d d = a[1] - a[0];
    const Eigen::Vector2d normal = Eigen::Vector2d(d.y(), -d.x()).normalized();
    const double t = std::clamp((q - a[0]).dot(d) / d.squaredNorm(), 0.0, 1.0);
    const Eigen::Vector2d offset = q - (a[0] + t * d);
    if (offset.squaredNorm() < nearest) {
      nearest = offset.squaredNorm();
      to_point = offset;
    }
    if (const double depth = normal.dot(q - a[0]); depth > behind) {
      behind = depth;
      plane_normal = normal;
    }
  }
  const double length = std::sqrt(nearest);
  const bool outside = behind > 0.0 && length > 1e-12;
  const Eigen::Vector2d normal = outside ? Eigen::Vector2d(to_point / length) : plane_normal;
  Vec3 result = normal.x() * radial;
  result[axis] += normal.y();
  return {outside ? length : behind, result};
}

// By the faces, exactly.
SurfaceDistance polyhedron_distance(const ColliderShape& s, const Vec3& p) {
  SurfaceDistance inside{-std::numeric_limits<double>::infinity(), Vec3::UnitY()};
  double nearest = std::numeric_limits<double>::infinity();
  Vec3 offset = Vec3::UnitY();
  for (const ShapeFacet& facet : s.facets) {
    const double distance = facet.normal.dot(p) - facet.offset;
    if (distance > inside.distance) {
      inside = {distance, facet.normal};
    }
    if (distance > 0.0 && distance * distance < nearest) {
      const Vec3 w = nearest_weights(p, facet.a, facet.b, facet.c);
      const Vec3 to_point = p - (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c);
      if (to_point.squaredNorm() < nearest) {
        nearest = to_point.squaredNorm();
        offset = to_point;
      }
    }
  }
  const double length = std::sqrt(nearest);
  if (inside.distance <= 0.0 || length < 1e-9) {
    return inside;
  }
  return {length, offset / length};
}

// As Bullet's GJK and EPA have it, margin included.
SurfaceDistance round_distance(const ColliderShape& s, const Vec3& p) {
  btGjkEpaSolver2::sResults result;
  const btScalar distance =
      btGjkEpaSolver2::SignedDistance(to_bullet(p), 0, s.convex, btTransform::getIdentity(), result);
  const Vec3 normal = from_bullet(result.normal);
  const double length = normal.norm();
  if (distance >= SIMD_INFINITY || !(length > 0.5)) {
    return {std::numeric_limits<double>::infinity(), Vec3::UnitY()};
  }
  return {double(distance), normal / length};
}

}  // namespace

SurfaceDistance ColliderShape::distance(const Vec3& p) const {
  switch (kind) {
    case Kind::plane:
      return {plane_normal.dot(p) - plane_offset, plane_normal};
    case Kind::sphere:
      return ball_distance(Vec3::Zero(), radius, p, 1);
    case Kind::box:
      return box_distance(half, p);
    case Kind::capsule: {
      Vec3 center = Vec3::Zero();
      center[axis] = std::clamp(p[axis], -half[axis], half[axis]);
      return ball_distance(center, radius, p, (axis + 1) % 3);
    }
    case Kind::cylinder: {
      const double h = half[axis];
      return turned_distance(p, axis, {{0, -h}, {radius, -h}, {radius, h}, {0, h}});
    }
    case Kind::cone: {
      const double h = half[axis];
      return turned_distance(p, axis, {{0, -h}, {radius, -h}, {0, h}});
    }
    case Kind::polyhedron:
      return polyhedron_distance(*this, p);
    case Kind::round:
      return round_distance(*this, p);
    case Kind::mesh:
    case Kind::unsupported:
      break;
  }
  return {std::numeric_limits<double>::infinity(), Vec3::UnitY()};
}

bool ColliderShape::beyond(const Vec3& p, double reach) const {
  if (kind == Kind::plane) {
    return plane_normal.dot(p) - plane_offset > reach;
  }
  return (p - bounds_max).maxCoeff() > reach || (bounds_min - p).maxCoeff() > reach;
}

bool is_mesh(const btCollisionShape& shape) {
  return shape.isConcave() && shape.getShapeType() != STATIC_PLANE_PROXYTYPE &&
         shape.getShapeType() != EMPTY_SHAPE_PROXYTYPE && shape.getShapeType() != SDF_SHAPE_PROXYTYPE;
}

void ColliderShapes::begin_substep() {
  constexpr long long kMemory = 1024;  // substeps
  if (++substep_ % kMemory == 0) {
    std::erase_if(entries_, [&](const auto& item) { return substep_ - item.second.last_used > kMemory; });
  }
}

double ColliderShape::core_radius() const {
  return kind == Kind::round ? double(convex->getMargin()) : radius;
}

bool ColliderShape::core_distance(const Vec3& a, const Vec3& b, const Vec3& c, CoreDistance& result) const {
  if (kind == Kind::round) {
    btTriangleShape triangle(to_bullet(a), to_bullet(b), to_bullet(c));
    btGjkEpaSolver2::sResults gjk;
    const btVector3 guess = to_bullet((a + b + c) / 3.0);
    if (!btGjkEpaSolver2::Distance(convex, btTransform::getIdentity(), &triangle, btTransform::getIdentity(),
                                   guess, gjk)) {
      return false;
    }
    result.on_core = from_bullet(gjk.witnesses[0]);
    result.on_triangle = from_bullet(gjk.witnesses[1]);
  } else {
    // The distance from a point of the core to a convex set is convex along the core.
    double low = 0.0, high = half[axis] > 0.0 ? 1.0 : 0.0;
    const auto on_core = [&](double t) -> Vec3 { return (2.0 * t - 1.0) * half; };
    const auto on_triangle = [&](const Vec3& p) {
      const Vec3 w = nearest_weights(p, a, b, c);
      return Vec3(w[0] * a + w[1] * b + w[2] * c);
    };
    const auto squared = [&](double t) { return (on_core(t) - on_triangle(on_core(t))).squaredNorm(); };
    constexpr double kGolden = 0.6180339887498949;
    for (int i = 0; i < 30 && high > low; ++i) {
      const double left = high - kGolden * (high - low), right = low + kGolden * (high - low);
      (squared(left) < squared(right) ? high : low) = squared(left) < squared(right) ? right : left;
    }
    result.on_core = on_core(0.5 * (low + high));
    result.on_triangle = on_triangle(result.on_core);
  }
  result.distance = (result.on_triangle - result.on_core).norm();
  return result.distance > 1e-6;
}

const ColliderShape& ColliderShapes::get(const btCollisionShape& shape) {
  double now[9];
  fingerprint(shape, now);
  Entry& entry = entries_[&shape];
  entry.last_used = substep_;
  if (std::memcmp(entry.fingerprint, now, sizeof now) != 0) {
    entry.shape = build(shape);
    std::copy(std::begin(now), std::end(now), entry.fingerprint);
  }
  return entry.shape;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
