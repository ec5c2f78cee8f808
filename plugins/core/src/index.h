#pragma once

#include <cstddef>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Bullet counts in int, the standard containers do not.
inline std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace softpoint::inline SOFTPOINT_ABI
