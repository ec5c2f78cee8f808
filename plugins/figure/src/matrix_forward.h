#pragma once

#include <span>
#include <vector>

#include "softpoint/figure/figure_dynamics.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Forward dynamics the paper's way: T - B = H q'' with B by (3) and H by (4), an inverse dynamics a column,
// and elimination. O(N^3); of the dynamic joints only.
class MatrixForward {
 public:
  explicit MatrixForward(const FigureModel& model);

  // As FigureDynamics::forward(), through `dynamics`' own inverse dynamics.
  void forward(FigureDynamics& dynamics, const double* q, const double* qd, const double* tau, double* qdd,
               std::span<const Wrench> loads, double implicit_time);
  // As FigureDynamics::respond() and respond_to_torques(), in the state of the last forward().
  void respond(FigureDynamics& dynamics, std::span<const Wrench> loads, double* change);
  void respond_to_torques(const double* tau, double* change);

 private:
  void factor();
  void solve(double* x) const;  // by the factors, in place

  std::vector<int> free_;        // degrees of freedom that are dynamic
  std::vector<double> damping_;  // per degree of freedom
  std::vector<double> factors_;  // of their part of H: L and, on the diagonal, D of L D L^T
  std::vector<double> given_, zero_, unit_, column_, x_, at_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
