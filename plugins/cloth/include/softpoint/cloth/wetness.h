#pragma once

#include <span>
#include <string_view>

#include "softpoint/cloth/pattern.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What water does to a fabric. Saturation runs from 0, dry, to 1, full; in between all that is here follows
// it in a straight line.
struct Wetness {
  double capacity = 0.7;         // mass of water over dry mass at saturation 1; 0 to 100
  double friction_factor = 3;    // friction at saturation 1 over dry friction; 0.01 to 100
  double warp_factor = 1;        // stiffness at saturation 1 over dry stiffness; 0.001 to 1000; along warp,
  double weft_factor = 1;        //  weft,
  double shear_factor = 1;       //  of diagonals
  double bending_factor = 1;     //  and against bending
  double pore_diameter = 50e-6;  // m, 1e-9 to 1; between yarns, where air bursts through: AirSettings
  double permeability = 1e-3;    // m/(s Pa), 0 to 1e3; of the dry weave: AirSettings
};

// Throws Error naming the field, as "<name>.capacity" and so on.
SOFTPOINT_API void check(const Wetness& wetness, std::string_view name = "wetness");

// Friction of wet cloth over dry friction.
SOFTPOINT_API double friction_factor(const Wetness& wetness, double saturation);

// Writes into `wet`, a copy of `dry`, the masses and stiffnesses it has at this saturation of its points; a
// spring takes the mean of its ends. Nothing else changes and nothing is allocated. Throws Error for another
// number of points or a saturation outside 0 to 1, with `wet` as it was.
SOFTPOINT_API void wet_pattern(const ClothPattern& dry, std::span<const double> saturation,
                               const Wetness& wetness, ClothPattern& wet);

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
