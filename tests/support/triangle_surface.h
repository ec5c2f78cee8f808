#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "softpoint/core/shapes.h"
#include "support/penetration.h"

namespace softpoint {

// What a mesh shape was made from, for measures of penetration that know nothing of Bullet's mesh or of the
// library's patches: either the boundary of a solid, facing outward, or a terrain y = height(x, z), solid
// below.
struct TriangleSurface {
  std::vector<std::array<Vec3, 3>> triangles;  // m, frame of the shape
  bool terrain = false;

  // Signed distance (m, negative inside) from a point in the shape's frame. Above a terrain it is the height,
  // and beside it infinite.
  double distance(const Vec3& p) const {
    double nearest = std::numeric_limits<double>::infinity(), angle = 0;
    double height = -std::numeric_limits<double>::infinity();
    for (const auto& [u, v, w] : triangles) {
      if (terrain) {
        height = std::max(height, height_over(p, u, v, w));
        continue;
      }
      nearest = std::min(nearest, triangle_distance(p, u, v, w));
      const Vec3 a = u - p, b = v - p, c = w - p;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      angle +=
          2.0 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    if (!terrain) {
      return angle > 2.0 * std::numbers::pi ? -nearest : nearest;
    }
    if (p.y() >= height) {
      return p.y() - height;
    }
    for (const auto& [u, v, w] : triangles) {
      nearest = std::min(nearest, triangle_distance(p, u, v, w));
    }
    return -nearest;
  }

  // Each corner once.
  std::vector<Vec3> corners() const {
    std::vector<Vec3> all;
    for (const auto& t : triangles) all.insert(all.end(), t.begin(), t.end());
    const auto less = [](const Vec3& a, const Vec3& b) {
      return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
    };
    std::sort(all.begin(), all.end(), less);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }

 private:
  // Height of the triangle at (p.x, p.z), minus infinity beside it.
  static double height_over(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto cross = [](const Vec3& u, const Vec3& v) { return u.x() * v.z() - u.z() * v.x(); };
    const double whole = cross(b - a, c - a);
    const double wb = cross(p - a, c - a) / whole, wc = cross(b - a, p - a) / whole;
    constexpr double kSlack = 1e-9;
    if (wb < -kSlack || wc < -kSlack || wb + wc > 1.0 + kSlack) {
      return -std::numeric_limits<double>::infinity();
    }
    return a.y() + wb * (b.y() - a.y()) + wc * (c.y() - a.y());
  }
};

inline TriangleSurface surface_of(const TriangleMesh& mesh) {
  TriangleSurface surface;
  for (const Triangle& t : mesh.triangles) {
    surface.triangles.push_back({mesh.vertices[static_cast<std::size_t>(t[0])],
                                 mesh.vertices[static_cast<std::size_t>(t[1])],
                                 mesh.vertices[static_cast<std::size_t>(t[2])]});
  }
  return surface;
}

// How far the deepest vertex of the skin is inside the surface (m, > 0 inside).
inline double skin_depth(const Surface& skin, const TriangleSurface& surface, const btTransform& placed) {
  const btTransform inverse = placed.inverse();
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : skin.points()) {
    const btVector3 local = inverse * btVector3(btScalar(p.x()), btScalar(p.y()), btScalar(p.z()));
    deepest = std::max(deepest, -surface.distance(Vec3(local.x(), local.y(), local.z())));
  }
  return deepest;
}

// How far the deepest corner of the surface is inside the skin (m, > 0 inside).
inline double corner_depth(const Surface& skin, const TriangleSurface& surface, const btTransform& placed) {
  std::vector<Vec3> corners = surface.corners();
  for (Vec3& c : corners) {
    const btVector3 w = placed * btVector3(btScalar(c.x()), btScalar(c.y()), btScalar(c.z()));
    c = Vec3(w.x(), w.y(), w.z());
  }
  return depth_in_skin(skin, corners, {});
}

// How far the deepest vertex of one skin is inside the other (m, > 0 inside).
inline double skin_in_skin(const Surface& one, const Surface& other) {
  return depth_in_skin(other, one.points(), {});
}

}  // namespace softpoint
