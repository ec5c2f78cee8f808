#pragma once

#include <span>
#include <vector>

#include "kernels.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Numbers after the last of x and y that the product of a packed symmetric matrix reads and writes, at most.
constexpr std::size_t kSymmetricPadding = 16;

// The symmetric n x n `matrix` as Kernels::packed_symmetric_single reads it: half its numbers. First the
// diagonal, in whole strips; then panels of kernels.symmetric_panel columns from the strip that begins with
// their first row to the last, column beside column in each strip, zeros where the diagonal and what is above
// it would be. A strip has kernels.symmetric_strip rows.
inline std::vector<float> pack_symmetric(const Kernels& kernels, std::span<const double> matrix,
                                         std::ptrdiff_t n) {
  const std::ptrdiff_t strip = kernels.symmetric_strip, panel = kernels.symmetric_panel;
  std::vector<float> packed(static_cast<std::size_t>((n + strip - 1) / strip * strip));
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    packed[static_cast<std::size_t>(i)] = static_cast<float>(matrix[static_cast<std::size_t>(i * (n + 1))]);
  }
  for (std::ptrdiff_t first = 0; first < n; first += panel) {
    for (std::ptrdiff_t top = first; top < n; top += strip) {
      for (std::ptrdiff_t j = first; j < first + panel; ++j) {
        for (std::ptrdiff_t i = top; i < top + strip; ++i) {
          const bool below = j < n && i < n && i > j;
          packed.push_back(below ? static_cast<float>(matrix[static_cast<std::size_t>(i + j * n)]) : 0.0F);
        }
      }
    }
  }
  return packed;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
