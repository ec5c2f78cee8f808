#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// How a figure is moved on by one step. All but the paper's work on the group: turns are composed, never
// added.
enum class Integrator {
  kPaper,          // (5) and (6): semi-implicit Euler, order 1
  kRungeKutta4,    // order 4, the default
  kDormandPrince,  // order 5, the exact setting
  kVariational,    // order 2, discrete mechanics: momentum is kept to rounding, energy does not drift
};
// "paper", "rk4", "dopri5", "variational".
SOFTPOINT_API const char* name(Integrator integrator);
// Its order of convergence.
SOFTPOINT_API int order(Integrator integrator);

// How the range [lower, upper] of hinges and prismatic joints is kept.
enum class LimitMode {
  kNone,
  kPaper,  // steps (1) to (11) of the paper, read cumulatively; with Integrator::kPaper only
  kExact,  // inelastic stops: impact and release located inside the step, no torque that pulls
};
// "none", "paper", "exact".
SOFTPOINT_API const char* name(LimitMode mode);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
