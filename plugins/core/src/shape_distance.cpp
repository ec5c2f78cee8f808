// Distances to shapes and from their cores.
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "collider_shape.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

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

}  // namespace softpoint::inline SOFTPOINT_ABI
