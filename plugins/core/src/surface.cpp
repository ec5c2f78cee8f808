#include "softpoint/core/surface.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

Vec3 interpolate(const Surface& surface, std::span<const Vec3> values, int face, const Vec3& weights) {
  const Triangle& t = surface.faces()[static_cast<std::size_t>(face)];
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    sum += weights[static_cast<Eigen::Index>(k)] * values[static_cast<std::size_t>(t[k])];
  }
  return sum;
}

}  // namespace

Vec3 point_at(const Surface& surface, int face, const Vec3& weights) {
  return interpolate(surface, surface.points(), face, weights);
}

Vec3 velocity_at(const Surface& surface, int face, const Vec3& weights) {
  return interpolate(surface, surface.velocities(), face, weights);
}

}  // namespace softpoint::inline SOFTPOINT_ABI
