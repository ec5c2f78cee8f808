#pragma once

#include <LinearMath/btTransform.h>

#include "softpoint/core/vec.h"
#include "softpoint/picture/renderer.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

inline Vec3 to_vec3(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline Color to_color(const btVector3& v, float opacity = 1.0F) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), opacity};
}

inline Pose to_pose(const btTransform& transform) {
  Pose pose;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.linear(r, c) = transform.getBasis()[r][c];
  }
  pose.origin = to_vec3(transform.getOrigin());
  return pose;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
