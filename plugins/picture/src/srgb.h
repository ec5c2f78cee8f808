#pragma once

#include <algorithm>
#include <cmath>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// IEC 61966-2-1. Both clamp to [0, 1].
inline double decode_srgb(double value) {
  const double v = std::clamp(value, 0.0, 1.0);
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

inline double encode_srgb(double value) {
  const double v = std::clamp(value, 0.0, 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
