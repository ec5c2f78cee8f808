#pragma once

#include <vector>

#include "softpoint/figure/figure_dynamics.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// (24) of doc/dynamics.md: a free base takes up what an integrator has missed of the momentum, which gravity
// alone changes in flight.
class MomentumKeeper {
 public:
  explicit MomentumKeeper(const FigureModel& model);
  // Corrects the base's entries in `rates`, those of `to` so far, `dt` s after `from`. `rates` may be to.qd.
  void keep(const Vec3& gravity, double dt, const FigureState& from, const FigureState& to,
            std::vector<double>& rates);

 private:
  FigureDynamics placer_;
  std::vector<double> unit_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
