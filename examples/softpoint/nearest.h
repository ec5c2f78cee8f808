#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Least number of letters to insert, remove, replace, or swap with their neighbour.
int edit_distance(std::string_view a, std::string_view b);

// The candidate that `word` was probably meant to be, or "".
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
