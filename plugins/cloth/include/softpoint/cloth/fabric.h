#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What a cloth is made of. Stiffnesses are those of the springs of a grid, which do not depend on its
// spacing: a sheet of square cells with structural springs k and diagonals k/2 stretches like a membrane of E
// h = 4k/3 and Poisson's ratio 1/3.
struct Fabric {
  double area_density = 0.2;       // dry mass per area, kg/m^2; kMinAreaDensity to kMaxAreaDensity
  double warp_stiffness = 1e4;     // of a spring along the warp (x of a pattern), N/m; to kMaxSpringStiffness
  double weft_stiffness = 1e4;     // along the weft (y of a pattern), N/m
  double shear_stiffness = 2.5e3;  // of a diagonal spring, N/m
  double bending_stiffness = 0;    // per width, N m; 0 to kMaxBendingStiffness
  double compression_ratio = 0.05;  // stiffness of a shortened spring over that of a stretched one, 0 to 1
  double damping_time =
      1e-4;              // a spring's damper is this (s) times its stiffness, along it; 0 to kMaxDampingTime
  double drag_rate = 1;  // a point slows down against the air by this part a second, 1/s; 0 to kMaxDragRate
  double thickness = 3e-4;  // m; cloth keeps this distance from itself, half of it from colliders; 0 to 0.1
};

// Lighter than any film, kg/m^2.
inline constexpr double kMinAreaDensity = 1e-5;
// A plate of steel 12 mm thick, kg/m^2.
inline constexpr double kMaxAreaDensity = 100;
// Of springs, N/m.
inline constexpr double kMaxSpringStiffness = 1e8;
// Per width, N m.
inline constexpr double kMaxBendingStiffness = 1e3;
// Longest damping time, s.
inline constexpr double kMaxDampingTime = 1;
// Strongest drag, 1/s.
inline constexpr double kMaxDragRate = 1e4;

// Throws Error naming the field, as "<name>.area_density" and so on.
SOFTPOINT_API void check(const Fabric& fabric, std::string_view name = "fabric");

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
