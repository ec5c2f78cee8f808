#pragma once

#include <span>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Speeds up projected Gauss-Seidel: takes the changes of successive sweeps for the descent directions of a
// nonlinear conjugate gradient method (Fletcher-Reeves) with restarts, so that what spreads slowly from
// contact to contact keeps its pace (Silcowitz, Niebe, Erleben, "A nonsmooth nonlinear conjugate gradient
// method for interactive contact force problems", 2010). The state is every number that sweeps change
// linearly: impulses and what follows from them.
class ConjugateSweeps {
 public:
  // Before the first sweep of a solve.
  void begin() {
    last_size_ = 0.0;
    direction_.clear();
  }

  // Before a sweep: notes the state, given as visit(span).
  template <class VisitState>
  void remember(VisitState visit_state) {
    before_.clear();
    visit_state(
        [&](std::span<double> values) { before_.insert(before_.end(), values.begin(), values.end()); });
  }
  // After a sweep: notes what it has changed.
  template <class VisitState>
  void compare(VisitState visit_state) {
    std::size_t i = 0;
    visit_state([&](std::span<double> values) {
      for (const double value : values) {
        before_[i] = value - before_[i];
        ++i;
      }
    });
    direction_.resize(before_.size(), 0.0);
  }
  // The change of one number of the state, in the order of the visit, and the direction it has been going on.
  double change(std::size_t index) const { return before_[index]; }
  double direction(std::size_t index) const { return direction_[index]; }

  // After compare(), where the change has the squared size `size` and the product `along` with the direction:
  // goes on in the conjugate direction, or starts anew where sweeps grow or turn back (it has gone too far).
  // The next sweep projects the result back on the constraints.
  template <class VisitState>
  void extrapolate(VisitState visit_state, double size, double along) {
    const bool restart = !(last_size_ > 0.0) || !(size <= last_size_) || !(along >= 0.0);
    const double beta = restart ? 0.0 : size / last_size_;
    last_size_ = size;
    std::size_t i = 0;
    visit_state([&](std::span<double> values) {
      for (double& value : values) {
        const double onward = restart ? 0.0 : beta * direction_[i];
        value += onward;
        direction_[i] = onward + before_[i];
        ++i;
      }
    });
  }

 private:
  std::vector<double> before_;  // the state before the sweep, then its change
  std::vector<double> direction_;
  double last_size_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
