#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "softpoint/core/config.h"

// The program exists once per Bullet precision, side by side: softpoint and softpoint-float64.
namespace softpoint::inline SOFTPOINT_ABI::scene {

enum class Precision { kSingle, kDouble };

#if defined(BT_USE_DOUBLE_PRECISION)
inline constexpr Precision kBuiltPrecision = Precision::kDouble;
#else
inline constexpr Precision kBuiltPrecision = Precision::kSingle;
#endif

// Where the program of that precision is expected: beside the running one.
std::filesystem::path sibling_path(Precision precision);

// If `precision` is not the one this program was built for, become the other program with the same
// `arguments` (argv, its head included) and do not return. Throws Error if that is not there.
void exec_sibling(Precision precision, const std::vector<std::string>& arguments);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
