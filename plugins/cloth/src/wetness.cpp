#include "softpoint/cloth/wetness.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

double grown(double factor, double saturation) { return 1 + (factor - 1) * saturation; }

double factor_of(const Wetness& wetness, SpringKind kind) {
  switch (kind) {
    case SpringKind::kWarp:
      return wetness.warp_factor;
    case SpringKind::kWeft:
      return wetness.weft_factor;
    case SpringKind::kShear:
      return wetness.shear_factor;
    case SpringKind::kBend:
      return wetness.bending_factor;
  }
  return 1;
}

}  // namespace

void check(const Wetness& wetness, std::string_view name) {
  const std::string prefix = std::string(name) + ".";
  check_range(prefix + "capacity", wetness.capacity, 0, 100);
  check_range(prefix + "friction_factor", wetness.friction_factor, 0.01, 100);
  check_range(prefix + "warp_factor", wetness.warp_factor, 0.001, 1000);
  check_range(prefix + "weft_factor", wetness.weft_factor, 0.001, 1000);
  check_range(prefix + "shear_factor", wetness.shear_factor, 0.001, 1000);
  check_range(prefix + "bending_factor", wetness.bending_factor, 0.001, 1000);
  check_range(prefix + "pore_diameter", wetness.pore_diameter, 1e-9, 1);
  check_range(prefix + "permeability", wetness.permeability, 0, 1e3);
}

double friction_factor(const Wetness& wetness, double saturation) {
  return grown(wetness.friction_factor, saturation);
}

void wet_pattern(const ClothPattern& dry, std::span<const double> saturation, const Wetness& wetness,
                 ClothPattern& wet) {
  check(wetness);
  if (saturation.size() != dry.points.size() || wet.masses.size() != dry.masses.size() ||
      wet.springs.size() != dry.springs.size() || wet.bends.size() != dry.bends.size()) {
    throw Error("saturation: " + std::to_string(saturation.size()) + " values; permitted: one a point, " +
                std::to_string(dry.points.size()));
  }
  for (const double value : saturation) check_range("saturation", value, 0, 1);
  for (std::size_t i = 0; i < dry.masses.size(); ++i) {
    wet.masses[i] = dry.masses[i] * (1 + wetness.capacity * saturation[i]);
  }
  for (std::size_t i = 0; i < dry.springs.size(); ++i) {
    const Spring& spring = dry.springs[i];
    const double mean = (saturation[spring.a] + saturation[spring.b]) / 2;
    wet.springs[i].stiffness = spring.stiffness * grown(factor_of(wetness, spring.kind), mean);
  }
  for (std::size_t i = 0; i < dry.bends.size(); ++i) {
    const BendElement& bend = dry.bends[i];
    double mean = 0;
    for (const int point : bend.point) mean += saturation[point] / 4;
    wet.bends[i].stiffness = bend.stiffness * grown(wetness.bending_factor, mean);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
