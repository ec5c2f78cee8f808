#include "softpoint/cloth/paper_settings.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

PaperSettings reference_paper_settings(double step) {
  PaperSettings settings;
  settings.step = step;
  settings.pressure = PaperPressure::kVolumeGradient;
  settings.friction = PaperFriction::kImpulse;
  check(settings);
  return settings;
}

void check(const PaperSettings& settings, std::string_view name) {
  const std::string prefix = std::string(name) + ".";
  check_range(prefix + "step", settings.step, kMinSubstep, 1);
  check_range(prefix + "sphere_diameter", settings.sphere_diameter, 0, 0.1);
  check_range(prefix + "sphere_friction", settings.sphere_friction, 0, 10);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
