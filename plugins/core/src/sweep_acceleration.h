#pragma once

#include <Eigen/Core>

#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Anderson's acceleration of Gauss-Seidel sweeps. Where a hundred contacts lie on one soft body, each sweep
// hands on what it found from one to the next, and hundreds are needed; from the changes of the last few,
// impulses are extrapolated to where the sweeps would change nothing. What comes out is a guess: the next
// sweep judges it.
class SweepAcceleration {
 public:
  // For `contacts` of them, whose impulses are weighed by `weights`.
  void begin(std::size_t contacts);
  double& weight(std::size_t contact) { return weights_[static_cast<Eigen::Index>(contact)]; }
  // Impulses (N s) before and after a sweep.
  Eigen::Ref<Eigen::Vector3d> before(std::size_t contact) { return before_.segment<3>(first(contact)); }
  Eigen::Ref<Eigen::Vector3d> after(std::size_t contact) { return after_.segment<3>(first(contact)); }
  // Puts better ones into after(); false when there are none.
  bool improve();

 private:
  static constexpr Eigen::Index kMemory = 6;
  static Eigen::Index first(std::size_t contact) { return 3 * static_cast<Eigen::Index>(contact); }

  Eigen::Index size_ = 0, pairs_ = 0, newest_ = 0;
  double least_ = 0;
  bool known_ = false;
  Eigen::VectorXd weights_, before_, after_, change_, last_change_, last_after_;
  Eigen::Matrix<double, Eigen::Dynamic, kMemory> changes_, afters_;  // differences from sweep to sweep
};

}  // namespace softpoint::inline SOFTPOINT_ABI
