#include "softpoint/cloth/cloth_settings.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

ClothSettings settings_of(Dial dial) {
  ClothSettings settings;
  switch (dial) {
    case Dial::kFast:
      settings.max_substep = 1.0 / 600;
      settings.march_step = 1.0 / 12000;
      break;
    case Dial::kDefault:
      break;
    case Dial::kExact:
      settings.max_substep = 1.0 / 12000;
      settings.march_step = 1.0 / 36000;
      settings.max_move = 0.1;
      settings.sweeps = 4;
      settings.precision = Precision::kDouble;
      break;
  }
  return settings;
}

void check(const ClothSettings& settings, std::string_view name) {
  const std::string at = std::string(name) + ".";
  check_range(at + "max_substep", settings.max_substep, kMinSubstep, 1);
  check_range(at + "march_step", settings.march_step, 0, 1);
  check_range(at + "max_move", settings.max_move, 0, 1000);
  check_range(at + "max_substeps", settings.max_substeps, 1, 100000);
  check_range(at + "sweeps", settings.sweeps, 1, 1000);
  check_range(at + "coarse_every", settings.coarse_every, 0, 1000000);
  check_range(at + "coarse_points", settings.coarse_points, 2, 64);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
