#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What the solver did and skipped since it was made.
struct SolverProfile {
  long long frames = 0;
  long long substeps = 0;
  long long marched = 0;         // explicit steps
  long long march_refused = 0;   // small steps of them taken back
  long long sweeps = 0;          // over all colours
  long long coarse_steps = 0;    // coarse corrections tried
  long long coarse_taken = 0;    // of them, those that lowered the energy
  long long coarse_skipped = 0;  // small steps without one: nothing moved fast
  long long boyle_solves = 0;    // colours whose pressure was solved
  long long boyle_repeats = 0;   // of them, solved anew because contacts changed
  long long air_skipped = 0;     // small steps without pressure: dry, or every pocket open
  long long guard_checks = 0;    // energies compared
  long long guard_skipped = 0;   // small steps without: calm
  long long guard_sweeps = 0;    // first rung: more sweeps
  long long guard_restarts = 0;  // second rung: begun anew
  long long guard_damped = 0;    // third rung: relative velocity damped
  long long non_finite = 0;      // steps put back because a number was not finite
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
