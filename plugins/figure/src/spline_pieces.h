#pragma once

#include <cstddef>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Throws Error unless the times make a spline of so many values.
void check_spline_times(const std::vector<double>& times, std::size_t values);
// The piece that holds a time, the first or last one beyond the ends.
std::size_t spline_piece(const std::vector<double>& times, double time);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
