#include "runge_kutta.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr ButcherTable kClassic = {
    4,
    {0, 0.5, 0.5, 1},
    {{}, {0.5}, {0, 0.5}, {0, 0, 1}},
    {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6},
};

// Dormand and Prince 1980, RK5(4)7M, the solution of order 5.
constexpr ButcherTable kDormandPrince = {
    6,
    {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1},
    {{},
     {1.0 / 5},
     {3.0 / 40, 9.0 / 40},
     {44.0 / 45, -56.0 / 15, 32.0 / 9},
     {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
     {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656}},
    {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};

}  // namespace

const ButcherTable& butcher_table(Integrator integrator) {
  return integrator == Integrator::kDormandPrince ? kDormandPrince : kClassic;
}

const char* name(Integrator integrator) {
  switch (integrator) {
    case Integrator::kPaper:
      return "paper";
    case Integrator::kRungeKutta4:
      return "rk4";
    case Integrator::kDormandPrince:
      return "dopri5";
    case Integrator::kVariational:
      break;
  }
  return "variational";
}

int order(Integrator integrator) {
  switch (integrator) {
    case Integrator::kPaper:
      return 1;
    case Integrator::kRungeKutta4:
      return 4;
    case Integrator::kDormandPrince:
      return 5;
    case Integrator::kVariational:
      break;
  }
  return 2;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
