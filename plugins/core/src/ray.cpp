#include <algorithm>

#include "bullet_math.h"
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {

std::optional<RayHit> DeformableSystem::pick(const Vec3& from, const Vec3& to) const {
  check_finite("pick: from", from);
  check_finite("pick: to", to);
  RayHit nearest;
  nearest.fraction = 1.0;
  const Vec3 d = to - from;
  for (Deformable* body : bodies()) {
    btScalar fraction = btScalar(1);
    btSoftBody::eFeature::_ feature = btSoftBody::eFeature::None;
    int face = -1;
    // The base class searches the face tree that the mirror keeps.
    const btSoftBody& mirror = *body;
    if (mirror.rayTest(to_bullet(from), to_bullet(to), fraction, feature, face, false) == 0 || face < 0 ||
        fraction >= nearest.fraction) {
      continue;
    }
    nearest.body = body;
    nearest.face = face;
    nearest.fraction = fraction;
  }
  if (nearest.body == nullptr) {
    return std::nullopt;
  }
  const Triangle& t = nearest.body->faces()[static_cast<std::size_t>(nearest.face)];
  const auto at = [&](std::size_t k) -> const Vec3& {
    return nearest.body->points()[static_cast<std::size_t>(t[k])];
  };
  nearest.position = from + nearest.fraction * d;
  const Vec3 normal = (at(1) - at(0)).cross(at(2) - at(0));
  const double area = normal.squaredNorm();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 part = (at((k + 1) % 3) - nearest.position).cross(at((k + 2) % 3) - nearest.position);
    nearest.weights[static_cast<Eigen::Index>(k)] = area > 0.0 ? part.dot(normal) / area : 1.0 / 3.0;
  }
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
