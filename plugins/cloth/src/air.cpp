#include "softpoint/cloth/air.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

AirSettings thesis_air(double initial_volume) {
  AirSettings settings;
  settings.bubbles = Bubbles::kOne;
  settings.initial_volume = initial_volume;
  settings.patch_suction = false;
  settings.limit_suction = false;
  settings.leak = false;
  settings.vent = false;
  settings.adhesion = false;
  return settings;
}

double bubble_point(const AirSettings& settings) {
  return 4 * settings.surface_tension * std::cos(settings.contact_angle) / settings.pore_diameter;
}

double film_pressure(const AirSettings& settings, double gap) {
  return 2 * settings.surface_tension * std::cos(settings.contact_angle) / std::max(gap, settings.film_gap);
}

double film_adhesion(const AirSettings& settings, double gap) {
  const double opened = 1 + std::max(gap, 0.0) / settings.film_gap;
  return film_pressure(settings, 0) / (opened * opened);
}

void check(const AirSettings& settings, std::string_view name) {
  const std::string prefix = std::string(name) + ".";
  const int bubbles = static_cast<int>(settings.bubbles);
  if (bubbles < 0 || bubbles > static_cast<int>(Bubbles::kFound)) {
    throw Error(prefix + "bubbles: " + std::to_string(bubbles) + "; permitted: off, one, found");
  }
  check_range(prefix + "ambient", settings.ambient, 0, 1e9);
  if (settings.initial_volume) {
    check_range(prefix + "initial_volume", *settings.initial_volume, 0, 1e6);
  }
  check_range(prefix + "touch_gap", settings.touch_gap, 0, 1);
  check_range(prefix + "release_gap", settings.release_gap, 0, 1);
  if (settings.release_gap < settings.touch_gap) {
    throw Error(prefix + "release_gap: " + to_text(settings.release_gap) +
                "; permitted: at least touch_gap, " + to_text(settings.touch_gap));
  }
  check_range(prefix + "lifetime", settings.lifetime, 1, 1000);
  check_range(prefix + "min_thickness", settings.min_thickness, 0, 1);
  check_range(prefix + "surface_tension", settings.surface_tension, 0, 10);
  check_range(prefix + "contact_angle", settings.contact_angle, 0, std::numbers::pi / 2);
  check_range(prefix + "pore_diameter", settings.pore_diameter, 1e-9, 1);
  check_range(prefix + "vapour_pressure", settings.vapour_pressure, 0, 1e9);
  check_range(prefix + "permeability", settings.permeability, 0, 1e3);
  check_range(prefix + "viscosity", settings.viscosity, 1e-9, 1);
  check_range(prefix + "film_gap", settings.film_gap, 1e-7, 0.1);
  check_range(prefix + "bridge_gap", settings.bridge_gap, 0, 1);
  check_range(prefix + "rim_width", settings.rim_width, 1e-6, 1);
  check_range(prefix + "wet", settings.wet, 0, 1);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
