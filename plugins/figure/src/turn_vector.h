#pragma once

#include <Eigen/Geometry>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The turn by a vector (axis times angle, rad) as a quaternion, and back (angle 0 to pi).
Eigen::Quaterniond turn_of(const Vec3& vector);
Vec3 vector_of(const Eigen::Quaterniond& turn);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
