#pragma once

#include <LinearMath/btScalar.h>

#include <type_traits>

namespace softpoint {

inline constexpr bool kDouble = std::is_same_v<btScalar, double>;

// What a law is held to in Bullet's double and single precision.
inline constexpr double by_precision(double in_double, double in_single) {
  return kDouble ? in_double : in_single;
}

}  // namespace softpoint
