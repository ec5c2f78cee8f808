#pragma once

#include <LinearMath/btTransform.h>

#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Bullet's numbers fit a double in either precision, so nothing is lost.
inline void archive_bullet(StateArchive& archive, const char* name, btScalar& value) {
  double wide = value;
  archive.number(name, wide, -1e30, 1e30);
  value = static_cast<btScalar>(wide);
}

inline void archive_bullet(StateArchive& archive, const char* name, btVector3& value) {
  for (int k = 0; k < 3; ++k) {
    archive_bullet(archive, name, value[k]);
  }
}

inline void archive_bullet(StateArchive& archive, const char* name, btQuaternion& value) {
  for (int k = 0; k < 4; ++k) {
    archive_bullet(archive, name, value[k]);
  }
}

inline void archive_bullet(StateArchive& archive, const char* name, btTransform& value) {
  for (int row = 0; row < 3; ++row) {
    archive_bullet(archive, name, value.getBasis()[row]);
  }
  archive_bullet(archive, name, value.getOrigin());
}

}  // namespace softpoint::inline SOFTPOINT_ABI
