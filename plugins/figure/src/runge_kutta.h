#pragma once

#include "softpoint/figure/integrator.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Butcher's table of an explicit method: stage i looks from the step's beginning by h sum_j a[i][j] k_j.
struct ButcherTable {
  int stages;
  double c[6];
  double a[6][6];
  double b[6];
};

const ButcherTable& butcher_table(Integrator integrator);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
