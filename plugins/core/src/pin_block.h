#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A symmetric, positive semi-definite system of 3x3 blocks, one per pinned point, factored once and solved
// often. Equations that those before them already imply (two pins on one point) are left out: their unknowns
// are zero.
class PinBlock {
 public:
  void resize(std::size_t pins);
  std::size_t size() const { return pins_; }
  // Block (i, j) with j <= i, before factorize().
  void set(std::size_t i, std::size_t j, const Mat3& block);
  void factorize();
  // Left out entirely.
  bool idle(std::size_t pin) const {
    return !pivot_[3 * pin] && !pivot_[3 * pin + 1] && !pivot_[3 * pin + 2];
  }
  // Right-hand sides in, unknowns out.
  void solve(std::span<Vec3> values) const;

 private:
  std::size_t pins_ = 0;
  Eigen::MatrixXd factor_;  // lower triangle
  Eigen::VectorXd diagonal_;
  std::vector<char> pivot_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
