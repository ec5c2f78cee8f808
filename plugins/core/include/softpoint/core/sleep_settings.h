#pragma once

#include <optional>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// When a deformable agrees to sleep.
struct SleepSettings {
  double speed = 0.1;          // m/s, 0 to 1e6; slower than this at every point it is at rest; 0: never
  std::optional<double> time;  // s, 0 to 1e6, at rest before it agrees; absent: Bullet's gDeactivationTime
};
// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const SleepSettings& settings);

}  // namespace softpoint::inline SOFTPOINT_ABI
