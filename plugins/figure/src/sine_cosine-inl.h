#pragma once

#include "softpoint/core/config.h"

// Sine and cosine without branches, for doubles and packs alike: to 1e-15 for angles up to a million turns,
// slowly worse beyond.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// Nearest whole number, by the rounding of an addition; |x| < 2^51.
template <class T>
inline T nearest_whole(const T& x) {
  constexpr double kShift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kShift) - kShift;
}

template <class T>
inline void sine_cosine(const T& angle, T& sine, T& cosine) {
  // Quarter turns taken off in three parts of pi/2, the first two of them short enough to multiply exactly.
  constexpr double kPerQuarter = 0.63661977236758134308;
  constexpr double kQuarter1 = 0x1.921fb54400000p+0;
  constexpr double kQuarter2 = 0x1.0b4611a600000p-34;
  constexpr double kQuarter3 = 0x1.3198a2e037073p-69;
  const T quarters = nearest_whole(angle * kPerQuarter);
  const T x = ((angle - quarters * kQuarter1) - quarters * kQuarter2) - quarters * kQuarter3;
  const T y = x * x;
  // Taylor's series: on |x| <= pi/4 the terms left out are below 1e-16.
  const T s =
      x + x * y *
              (-1.0 / 6 +
               y * (1.0 / 120 +
                    y * (-1.0 / 5040 +
                         y * (1.0 / 362880 + y * (-1.0 / 39916800 + y * (1.0 / 6227020800.0 +
                                                                         y * (-1.0 / 1307674368000.0)))))));
  const T c =
      1.0 +
      y * (-0.5 + y * (1.0 / 24 + y * (-1.0 / 720 +
                                       y * (1.0 / 40320 + y * (-1.0 / 3628800 +
                                                               y * (1.0 / 479001600.0 +
                                                                    y * (-1.0 / 87178291200.0 +
                                                                         y * (1.0 / 20922789888000.0))))))));
  // quarters mod 4: `turns` is its count of half turns (0 or 1), `odd` whether sine and cosine swap.
  const T half = nearest_whole(quarters * 0.5 - 0.25);  // floor(quarters / 2)
  const T odd = quarters - 2.0 * half;
  const T flips = half - 2.0 * nearest_whole(half * 0.5 - 0.25);
  const T sign = 1.0 - 2.0 * flips;
  sine = sign * (s + odd * (c - s));
  cosine = sign * (c - odd * (c + s));
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
