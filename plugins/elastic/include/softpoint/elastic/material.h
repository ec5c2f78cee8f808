#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Linear, isotropic, homogeneous.
struct Material {
  double young = 1e5;      // Young's modulus, Pa; kMinYoung to kMaxYoung
  double poisson = 0.3;    // Poisson's ratio; kMinPoisson to kMaxPoisson
  double density = 1000.;  // kg/m^3; kMinDensity to kMaxDensity
};

// Thermodynamics permits -1 to 1/2, both excluded. Towards 1/2 linear boundary elements lock:
// 4 % error at 0.49, 24 % at 0.4999 (82 vertices); towards -1 the shear modulus grows without bound.
inline constexpr double kMinPoisson = -0.9;
// Largest Poisson's ratio permitted.
inline constexpr double kMaxPoisson = 0.49;
// Softer than any foam, Pa.
inline constexpr double kMinYoung = 1e-6;
// Stiffer than any diamond, Pa.
inline constexpr double kMaxYoung = 1e15;
// Lighter than any gas, kg/m^3.
inline constexpr double kMinDensity = 1e-6;
// Heavier than any metal, kg/m^3.
inline constexpr double kMaxDensity = 1e9;

// Throws Error naming the field, as "<name>.young" and so on.
SOFTPOINT_API void check(const Material& material, std::string_view name = "material");
// The same for Poisson's ratio alone; `field` is its full name.
SOFTPOINT_API void check_poisson(std::string_view field, double poisson);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
