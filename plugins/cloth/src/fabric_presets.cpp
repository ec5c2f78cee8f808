#include "softpoint/cloth/fabric_presets.h"

#include <algorithm>
#include <array>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Sources, by letter. Where a letter stands for a range, the number is one of ours within it.
//   [M] W. E. Morton, J. W. S. Hearle, Physical Properties of Textile Fibres, 4th ed., 2008: how fibres take
//   up
//       water, swell, and lose stiffness by it.
//   [K] S. Kawabata, The Standardization and Analysis of Hand Evaluation, 2nd ed., 1980: the ranges of
//   stretch,
//       shear and bending of woven dress fabrics: 2 to 25 kN/m, 17 to 101 N/m, 10 to 66 uN m.
//   [I] Role of Hair Coverage and Sweating for Textile Friction on the Forearm, Leibniz Institute for New
//       Materials: friction of textiles rises 2 to 5 times on wet skin without hair.
//   [Y] W. Yamada, master's thesis, Tokyo University of Technology, 2012, chapter 2: plain weave stretches
//   least,
//       twill is suppler, satin the smoothest and slow to take up water; some fibres swell and make the cloth
//       stiffer, others soften.
//   [A] usual results of ISO 9237 (100 Pa) for tight woven dress fabrics, 20 to 200 mm/s; 0.1 m/s at 100 Pa
//   is
//       1e-3 m/(s Pa).
//   [G] a guess of ours.

struct WeaveNumbers {
  double stretch;       // factor on the fibre's stiffness; order plain > twill > satin [Y], numbers [G]
  double weft;          // weft over warp: warp floats lie straighter [Y], numbers [G]
  double shear;         // N/m, of the cloth; within [K], order by crossings a unit of area [Y]
  double bending;       // N m; within [K], order [Y]
  double friction;      // dry, on a smooth solid [G]; satin smoothest [Y]
  double pores;         // m [G]
  double permeability;  // m/(s Pa), within [A]
  double uptake;        // factor on the fibre's uptake of water; satin least [Y], numbers [G]
};

constexpr std::array<WeaveNumbers, 3> kWeaves{{
    {1.0, 1.0, 70, 40e-6, 0.40, 60e-6, 1.5e-3, 1.0},   // plain
    {0.8, 0.9, 50, 30e-6, 0.38, 50e-6, 1.0e-3, 0.95},  // twill
    {0.6, 0.8, 30, 20e-6, 0.32, 40e-6, 0.6e-3, 0.85},  // satin
}};

struct FiberNumbers {
  double area_density;  // kg/m2 of a light dress fabric [G]
  double stretch;       // N/m along the warp in plain weave, within [K]
  double capacity;      // water over dry mass, wet through and drained [G]; order by uptake [M]
  double friction;      // wet over dry, within [I]
  double
      stiffen;  // stretch and shear, wet over dry: swollen yarns jam the weave of cotton, linen and viscose
                //   [Y], softer fibres [M] win in wool and silk, polyester hardly takes up water [M]; [G]
  double bend;  // bending, wet over dry; likewise, numbers [G]
};

constexpr std::array<FiberNumbers, 7> kFibers{{
    {0.15, 12e3, 1.0, 4.0, 1.2, 1.3},   // cotton
    {0.13, 15e3, 0.7, 2.5, 1.0, 1.0},   // polyester
    {0.08, 10e3, 0.8, 3.0, 0.85, 0.8},  // silk
    {0.20, 4e3, 0.9, 3.0, 0.7, 0.7},    // wool
    {0.09, 8e3, 0.6, 2.5, 0.85, 0.85},  // nylon
    {0.17, 20e3, 1.0, 4.0, 1.3, 1.4},   // linen
    {0.14, 8e3, 1.0, 4.0, 0.6, 1.1},    // viscose: the fibre loses most of its modulus wet [M]
}};

constexpr std::array<std::string_view, 3> kWeaveNames{"plain", "twill", "satin"};
constexpr std::array<std::string_view, 7> kFiberNames{"cotton", "polyester", "silk",   "wool",
                                                      "nylon",  "linen",     "viscose"};

}  // namespace

FabricPreset fabric_preset(Weave weave, Fiber fiber) {
  const auto w = static_cast<long long>(weave), f = static_cast<long long>(fiber);
  check_index("weave", w, static_cast<long long>(kWeaves.size()));
  check_index("fiber", f, static_cast<long long>(kFibers.size()));
  const WeaveNumbers& weaving = kWeaves[w];
  const FiberNumbers& fibers = kFibers[f];
  FabricPreset preset;
  preset.fabric.area_density = fibers.area_density;
  preset.fabric.warp_stiffness = fibers.stretch * weaving.stretch;
  preset.fabric.weft_stiffness = fibers.stretch * weaving.stretch * weaving.weft;
  // Two diagonals of stiffness k in a square cell resist shear like a sheet of shear stiffness k.
  preset.fabric.shear_stiffness = weaving.shear;
  preset.fabric.bending_stiffness = weaving.bending;
  preset.wetness.capacity = fibers.capacity * weaving.uptake;
  preset.wetness.friction_factor = fibers.friction;
  preset.wetness.warp_factor = fibers.stiffen;
  preset.wetness.weft_factor = fibers.stiffen;
  preset.wetness.shear_factor = fibers.stiffen;
  preset.wetness.bending_factor = fibers.bend;
  preset.wetness.pore_diameter = weaving.pores;
  preset.wetness.permeability = weaving.permeability;
  preset.friction = weaving.friction;
  return preset;
}

AirSettings air_of(const FabricPreset& preset, AirSettings settings) {
  settings.pore_diameter = preset.wetness.pore_diameter;
  settings.permeability = preset.wetness.permeability;
  return settings;
}

std::span<const std::string_view> weave_names() { return kWeaveNames; }
std::span<const std::string_view> fiber_names() { return kFiberNames; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
