#pragma once

#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <btBulletDynamicsCommon.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "softpoint/core/surface.h"

// Slow and obvious measures of penetration, independent of the library's own contact code.
namespace softpoint {

// Distance (m) from a point to a triangle: its plane where the foot is inside, else the nearest side.
inline double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto side = [&](const Vec3& u, const Vec3& v) {
    const double t = std::clamp((p - u).dot(v - u) / (v - u).squaredNorm(), 0.0, 1.0);
    return (p - u - t * (v - u)).norm();
  };
  const Vec3 n = (b - a).cross(c - a);
  const bool above = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                     n.dot((a - c).cross(p - c)) >= 0;
  return above ? std::abs(n.dot(p - a)) / n.norm() : std::min({side(a, b), side(b, c), side(c, a)});
}

// Signed distance (m, negative inside) from a world point to a rigid shape: plane, sphere, box, capsule,
// cylinder, cone, convex hull (half-spaces through every triple of its points), compound (the deepest child).
// Shapes are taken as they are drawn, without the margin that Bullet adds to some.
inline double brute_distance(const btCollisionShape& shape, const btTransform& placed,
                             const Vec3& world_point) {
  Eigen::Matrix3d rotation;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      rotation(r, c) = placed.getBasis()[r][c];
    }
  }
  const btVector3& o = placed.getOrigin();
  const Vec3 p = rotation.transpose() * (world_point - Vec3(o.x(), o.y(), o.z()));
  const auto vec = [](const btVector3& v) { return Vec3(v.x(), v.y(), v.z()); };
  const auto box = [](const Vec3& half, const Vec3& q) {
    const Vec3 over = q.cwiseAbs() - half;
    return over.cwiseMax(0.0).norm() + std::min(over.maxCoeff(), 0.0);
  };
  switch (shape.getShapeType()) {
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      return vec(plane.getPlaneNormal()).dot(p) - plane.getPlaneConstant();
    }
    case SPHERE_SHAPE_PROXYTYPE:
      return p.norm() - static_cast<const btSphereShape&>(shape).getRadius();
    case BOX_SHAPE_PROXYTYPE:
      return box(vec(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin()), p);
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      Vec3 q = p;
      const int axis = capsule.getUpAxis();
      q[axis] = std::max(std::abs(q[axis]) - double(capsule.getHalfHeight()), 0.0);
      return q.norm() - capsule.getRadius();
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const int axis = cylinder.getUpAxis();
      Vec3 off = p;
      off[axis] = 0;
      const double over_r = off.norm() - double(cylinder.getRadius());
      const double over_h = std::abs(p[axis]) - double(cylinder.getHalfExtentsWithMargin()[axis]);
      return std::hypot(std::max(over_r, 0.0), std::max(over_h, 0.0)) +
             std::min(std::max(over_r, over_h), 0.0);
    }
    case CONE_SHAPE_PROXYTYPE: {  // the triangle (axis, rim, tip) in the half plane through the point
      const auto& cone = static_cast<const btConeShape&>(shape);
      const int axis = cone.getConeUpIndex();
      Vec3 off = p;
      off[axis] = 0;
      const double r = cone.getRadius(), h = cone.getHeight();
      const Vec3 q(off.norm(), p[axis], 0), rim(r, -h / 2, 0), tip(0, h / 2, 0), foot(0, -h / 2, 0);
      const auto side = [&](const Vec3& u, const Vec3& v) {
        const double t = std::clamp((q - u).dot(v - u) / (v - u).squaredNorm(), 0.0, 1.0);
        return (q - u - t * (v - u)).norm();
      };
      const double nearest = std::min(side(foot, rim), side(rim, tip));
      const bool inside = q.y() > -h / 2 && q.x() < r * (h / 2 - q.y()) / h;
      return inside ? -nearest : nearest;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE: {
      const auto& hull = static_cast<const btConvexHullShape&>(shape);
      double deepest = -std::numeric_limits<double>::infinity();
      double nearest = std::numeric_limits<double>::infinity();  // to a triangle of the surface
      const int count = hull.getNumPoints();
      for (int i = 0; i < count; ++i) {
        for (int j = i + 1; j < count; ++j) {
          for (int k = j + 1; k < count; ++k) {
            const Vec3 a = vec(hull.getScaledPoint(i)), b = vec(hull.getScaledPoint(j));
            const Vec3 c = vec(hull.getScaledPoint(k));
            Vec3 n = (b - a).cross(c - a);
            if (n.norm() < 1e-9) continue;
            n.normalize();
            double low = 0, high = 0;
            for (int m = 0; m < count; ++m) {
              const double d = n.dot(vec(hull.getScaledPoint(m)) - a);
              low = std::min(low, d);
              high = std::max(high, d);
            }
            if (high < 1e-6) deepest = std::max(deepest, n.dot(p - a));
            if (low > -1e-6) deepest = std::max(deepest, -n.dot(p - a));
            if (high < 1e-6 || low > -1e-6) nearest = std::min(nearest, triangle_distance(p, a, b, c));
          }
        }
      }
      return deepest > 0 ? nearest : deepest;
    }
    case COMPOUND_SHAPE_PROXYTYPE: {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      double nearest = std::numeric_limits<double>::infinity();
      for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        nearest = std::min(nearest, brute_distance(*compound.getChildShape(i),
                                                   placed * compound.getChildTransform(i), world_point));
      }
      return nearest;
    }
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

// How far the deepest point of the skin is inside the object (m, > 0 inside).
inline double skin_depth(const Surface& skin, const btCollisionObject& object) {
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : skin.points()) {
    deepest = std::max(deepest, -brute_distance(*object.getCollisionShape(), object.getWorldTransform(), p));
  }
  return deepest;
}

inline double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

inline double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = (b - a).cross(c - a).normalized();
  const bool over = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                    n.dot((a - c).cross(p - c)) >= 0;
  if (over) {
    return std::abs(n.dot(p - a));
  }
  return std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
}

// Signed distance from a point to a closed skin (negative inside, by the winding number).
inline double distance_to_skin(const Surface& skin, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity(), angle = 0;
  for (const Triangle& t : skin.faces()) {
    const auto at = [&](std::size_t k) -> const Vec3& {
      return skin.points()[static_cast<std::size_t>(t[k])];
    };
    nearest = std::min(nearest, distance_to_triangle(p, at(0), at(1), at(2)));
    const Vec3 a = at(0) - p, b = at(1) - p, c = at(2) - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle > 2.0 * std::numbers::pi ? -nearest : nearest;
}

// Corners of a shape and the radius of the ball round each that belongs to it: corners of boxes and hulls,
// centres of spheres, ends of a capsule's core, points on the rims of cylinders and cones, tips.
inline void shape_corners(const btCollisionShape& shape, const btTransform& placed,
                          std::vector<Vec3>& corners, std::vector<double>& radii) {
  const auto add = [&](const btVector3& local, double radius) {
    const btVector3 w = placed * local;
    corners.push_back(Vec3(w.x(), w.y(), w.z()));
    radii.push_back(radius);
  };
  const auto add_rim = [&](int axis, double radius, double height) {
    for (int i = 0; i < 45; ++i) {  // not the angles that the library knows
      const double angle = 0.01 + i * std::numbers::pi / 22.5;
      btVector3 p(0, 0, 0);
      p[axis] = btScalar(height);
      p[(axis + 1) % 3] = btScalar(radius * std::cos(angle));
      p[(axis + 2) % 3] = btScalar(radius * std::sin(angle));
      add(p, 0);
    }
  };
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE: {
      const btVector3 h = static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin();
      for (int i = 0; i < 8; ++i) {
        add(btVector3(i & 1 ? h.x() : -h.x(), i & 2 ? h.y() : -h.y(), i & 4 ? h.z() : -h.z()), 0);
      }
      break;
    }
    case SPHERE_SHAPE_PROXYTYPE:
      add(btVector3(0, 0, 0), static_cast<const btSphereShape&>(shape).getRadius());
      break;
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      btVector3 end(0, 0, 0);
      end[capsule.getUpAxis()] = capsule.getHalfHeight();
      add(end, capsule.getRadius());
      add(-end, capsule.getRadius());
      break;
    }
    case CONVEX_HULL_SHAPE_PROXYTYPE: {
      const auto& hull = static_cast<const btConvexHullShape&>(shape);
      for (int i = 0; i < hull.getNumPoints(); ++i) {
        add(hull.getScaledPoint(i), 0);
      }
      break;
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const int axis = cylinder.getUpAxis();
      const double h = cylinder.getHalfExtentsWithMargin()[axis];
      add_rim(axis, cylinder.getRadius(), h);
      add_rim(axis, cylinder.getRadius(), -h);
      break;
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      add_rim(cone.getConeUpIndex(), cone.getRadius(), -0.5 * double(cone.getHeight()));
      btVector3 tip(0, 0, 0);
      tip[cone.getConeUpIndex()] = btScalar(0.5) * cone.getHeight();
      add(tip, 0);
      break;
    }
    case COMPOUND_SHAPE_PROXYTYPE: {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        shape_corners(*compound.getChildShape(i), placed * compound.getChildTransform(i), corners, radii);
      }
      break;
    }
    default:
      break;
  }
}

// How far the deepest of balls (m) is inside the skin (m, > 0 inside); those that are farther than 5 cm from
// its bounds are not looked at, minus infinity when all are.
inline double depth_in_skin(const Surface& skin, std::span<const Vec3> centers,
                            std::span<const double> radii) {
  Vec3 low = skin.points().front(), high = low;
  for (const Vec3& p : skin.points()) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double deepest = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const double radius = radii.empty() ? 0.0 : radii[i];
    if ((low - centers[i]).maxCoeff() > radius + 0.05 || (centers[i] - high).maxCoeff() > radius + 0.05)
      continue;
    deepest = std::max(deepest, radius - distance_to_skin(skin, centers[i]));
  }
  return deepest;
}

// How far the deepest corner of the object is inside the skin (m, > 0 inside).
inline double corner_depth(const Surface& skin, const btCollisionObject& object) {
  std::vector<Vec3> corners;
  std::vector<double> radii;
  shape_corners(*object.getCollisionShape(), object.getWorldTransform(), corners, radii);
  return depth_in_skin(skin, corners, radii);
}

}  // namespace softpoint
