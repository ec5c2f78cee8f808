#pragma once

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Barycentric weights of the point of triangle a, b, c nearest to p.
Vec3 nearest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace softpoint::inline SOFTPOINT_ABI
