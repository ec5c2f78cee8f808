#include <algorithm>

#include "bullet_math.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {

std::optional<RayHit> DeformableSystem::pick(const Vec3& from, const Vec3& to) const {
  check_range("pick: from", from, -kMaxRay, kMaxRay);
  check_range("pick: to", to, -kMaxRay, kMaxRay);
  RayHit nearest;
  nearest.fraction = 1.0;
  const Vec3 d = to - from;
  for (Deformable* body : bodies()) {
    const std::span<const Vec3> points = body->points();
    const std::span<const Triangle> faces = body->faces();
    for (std::size_t f = 0; f < faces.size(); ++f) {
      // Moller-Trumbore, both sides, in double precision whatever Bullet's own is.
      const Vec3& a = points[static_cast<std::size_t>(faces[f][0])];
      const Vec3 e1 = points[static_cast<std::size_t>(faces[f][1])] - a;
      const Vec3 e2 = points[static_cast<std::size_t>(faces[f][2])] - a;
      const Vec3 q = d.cross(e2);
      const double determinant = e1.dot(q);
      if (determinant == 0.0) {
        continue;
      }
      const Vec3 s = from - a;
      const Vec3 r = s.cross(e1);
      const double u = s.dot(q) / determinant, v = d.dot(r) / determinant, time = e2.dot(r) / determinant;
      if (u < 0.0 || v < 0.0 || u + v > 1.0 || time < 0.0 || time > nearest.fraction ||
          (nearest.body != nullptr && time == nearest.fraction)) {
        continue;
      }
      nearest.body = body;
      nearest.face = static_cast<int>(f);
      nearest.fraction = time;
      nearest.weights = {1.0 - u - v, u, v};
    }
  }
  if (nearest.body == nullptr) {
    return std::nullopt;
  }
  const Triangle& t = nearest.body->faces()[static_cast<std::size_t>(nearest.face)];
  const auto at = [&](std::size_t k) -> const Vec3& {
    return nearest.body->points()[static_cast<std::size_t>(t[k])];
  };
  nearest.position = from + nearest.fraction * d;
  std::size_t closest = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if ((at(k) - nearest.position).squaredNorm() < (at(closest) - nearest.position).squaredNorm()) {
      closest = k;
    }
  }
  nearest.point = t[closest];
  return nearest;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
