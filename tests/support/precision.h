#pragma once

#include <LinearMath/btScalar.h>

#include <cstdlib>
#include <string_view>
#include <type_traits>

namespace softpoint {

inline constexpr bool kDouble = std::is_same_v<btScalar, double>;

// What a law is held to in Bullet's double and single precision.
inline constexpr double by_precision(double in_double, double in_single) {
  return kDouble ? in_double : in_single;
}

// The long tier: tests/run.sh --full.
inline bool full_tier() {
  const char* value = std::getenv("SOFTPOINT_TEST_FULL");
  return value != nullptr && std::string_view(value) == "1";
}

}  // namespace softpoint
