#pragma once

#include <LinearMath/btTransform.h>

#include "scene.h"

// Between our doubles and Bullet's scalars.
namespace softpoint::inline SOFTPOINT_ABI::scene {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

inline Vec3 from_bullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

inline btTransform to_bullet(const Placement& placement) {
  const Mat3& r = placement.rotation;
  const auto s = [&](int i, int j) { return static_cast<btScalar>(r(i, j)); };
  const btMatrix3x3 basis(s(0, 0), s(0, 1), s(0, 2), s(1, 0), s(1, 1), s(1, 2), s(2, 0), s(2, 1), s(2, 2));
  return btTransform(basis, to_bullet(placement.position));
}

inline Placement from_bullet(const btTransform& transform) {
  Placement placement;
  placement.position = from_bullet(transform.getOrigin());
  for (int i = 0; i < 3; ++i) {
    placement.rotation.row(i) = from_bullet(transform.getBasis()[i]);
  }
  return placement;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
