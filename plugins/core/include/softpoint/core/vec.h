#pragma once

#include <Eigen/Core>

#include <array>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Three doubles; metres, newtons, ... as the name of the holder says.
using Vec3 = Eigen::Vector3d;
// Row r, column c.
using Mat3 = Eigen::Matrix3d;
// Vertex indices of a triangle, counter-clockwise seen from outside.
using Triangle = std::array<int, 3>;

// 24 and 72 bytes are no multiple of 16, so Eigen never over-aligns these two whatever the
// instruction set: they may stand in public headers, other fixed-size Eigen types may not.
static_assert(sizeof(Vec3) == 24 && alignof(Vec3) == alignof(double));
static_assert(sizeof(Mat3) == 72 && alignof(Mat3) == alignof(double));

}  // namespace softpoint::inline SOFTPOINT_ABI
