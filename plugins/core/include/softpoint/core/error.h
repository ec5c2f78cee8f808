#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "softpoint/core/config.h"
#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The one exception of this project: thrown at construction and load, never inside a step.
// The message names the field, its value and what is permitted.
class SOFTPOINT_API Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Shortest text that reads back as the same double ("nan", "inf" for the non-finite).
SOFTPOINT_API std::string to_text(double value);
// "[1, 2.5, nan]"
SOFTPOINT_API std::string to_text(const Vec3& value);

// Refuse a value outside [low, high], or not finite.
SOFTPOINT_API void check_range(std::string_view field, double value, double low, double high);
SOFTPOINT_API void check_positive(std::string_view field, double value);
SOFTPOINT_API void check_not_negative(std::string_view field, double value);
SOFTPOINT_API void check_finite(std::string_view field, double value);
SOFTPOINT_API void check_finite(std::string_view field, const Vec3& value);
// The same for each of three components.
SOFTPOINT_API void check_range(std::string_view field, const Vec3& value, double low, double high);
// Refuse an index outside [0, count).
SOFTPOINT_API void check_index(std::string_view field, long long index, long long count);

}  // namespace softpoint::inline SOFTPOINT_ABI
