#include "turn_vector.h"

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {

Eigen::Quaterniond turn_of(const Vec3& vector) {
  const double angle = vector.norm();
  const double s = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * vector.x(), s * vector.y(), s * vector.z()};
}

Vec3 vector_of(const Eigen::Quaterniond& turn) {
  const double side = turn.w() < 0 ? -1 : 1;
  const double sine = turn.vec().norm();
  const double factor = sine < 1e-8 ? 2 / turn.w() * side : 2 * std::atan2(sine, side * turn.w()) / sine;
  return side * factor * turn.vec();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
