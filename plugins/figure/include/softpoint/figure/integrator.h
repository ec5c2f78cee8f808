#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// How a figure is moved on by one step. All but the paper's work on the group: turns are composed, never
// added.
enum class Integrator {
  kPaper,          // (5) and (6): semi-implicit Euler, order 1
  kRungeKutta4,    // order 4, the default
  kDormandPrince,  // order 5, the exact setting
};
// "paper", "rk4", "dopri5".
SOFTPOINT_API const char* name(Integrator integrator);
// Its order of convergence.
SOFTPOINT_API int order(Integrator integrator);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
