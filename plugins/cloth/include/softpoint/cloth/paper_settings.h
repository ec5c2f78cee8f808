#pragma once

#include <cstdint>
#include <string_view>

#include "softpoint/cloth/cloth_settings.h"
#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// How the air pushes a point in the `paper` mode.
enum class PaperPressure : std::int8_t {
  kConstantArea,    // (3.7): the same area for each point, along its normal
  kVolumeGradient,  // the exact gradient of the volume (3.10)
};

// What limits the friction of a point on the plane in the `paper` mode.
enum class PaperFriction : std::int8_t {
  kForces,   // (3.4) and (3.5): gravity, pressure and springs
  kImpulse,  // Signorini-Coulomb: all that keeps the point out of the plane, impacts too
};

// The wet-cloth thesis' own scheme, kept as the reference that everything else is measured against: explicit
// Verlet steps (3.1), the six forces (3.2) to (3.7), one bubble over a plane with (3.8) to (3.10), spheres
// for self-collision. Only for grids over one plane. It bursts when the step is too long for the springs; the
// longest stable one is below 1.5 sqrt(point mass / stiffest spring), and shorter with dampers. `Cloth` refuses
// steps that it cannot be sure of.
struct PaperSettings {
  double step = 1.0 / 12000;  // longest step, s; kMinSubstep to 1
  PaperPressure pressure = PaperPressure::kConstantArea;
  PaperFriction friction = PaperFriction::kForces;
  double sphere_diameter = 0;  // of the points, against each other, m; 0: no self-collision; to 0.1
  double sphere_friction = 0;  // between them; 0 to 10
  bool simd = true;            // false: the slow, obvious form, always in double precision
  Precision precision = Precision::kDouble;
};

// The variant that made the fine-step reference runs: exact gradient, friction by impulses.
SOFTPOINT_API PaperSettings reference_paper_settings(double step);

// Throws Error naming the field, as "<name>.step" and so on.
SOFTPOINT_API void check(const PaperSettings& settings, std::string_view name = "paper");

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
