#include "pin_block.h"

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Of its own diagonal: what is left of an equation that others imply. Above rounding, below the relative
// compliance of neighbours on the stiffest bodies.
constexpr double kImplied = 1e-12;

}  // namespace

void PinBlock::resize(std::size_t pins) {
  pins_ = pins;
  const auto n = static_cast<Eigen::Index>(3 * pins);
  if (factor_.rows() < n) {
    factor_.resize(n, n);
    diagonal_.resize(n);
  }
  pivot_.assign(3 * pins, 0);
}

void PinBlock::set(std::size_t i, std::size_t j, const Mat3& block) {
  factor_.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) = block;
}

// Cholesky's factorization, column by column.
void PinBlock::factorize() {
  const auto n = static_cast<Eigen::Index>(3 * pins_);
  auto a = factor_.topLeftCorner(n, n);
  diagonal_.head(n) = a.diagonal();
  for (Eigen::Index k = 0; k < n; ++k) {
    auto column = a.col(k).segment(k, n - k);
    for (Eigen::Index j = 0; j < k; ++j) {
      if (pivot_[static_cast<std::size_t>(j)] != 0) {
        column -= a(k, j) * a.col(j).segment(k, n - k);
      }
    }
    pivot_[static_cast<std::size_t>(k)] = a(k, k) > kImplied * diagonal_[k];
    if (pivot_[static_cast<std::size_t>(k)] != 0) {
      column /= std::sqrt(a(k, k));
    }
  }
}

void PinBlock::solve(std::span<Vec3> values) const {
  const auto n = static_cast<Eigen::Index>(3 * pins_);
  Eigen::Map<Eigen::VectorXd> x(values.front().data(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    if (pivot_[static_cast<std::size_t>(k)] == 0) {
      x[k] = 0.0;
      continue;
    }
    x[k] /= factor_(k, k);
    x.segment(k + 1, n - k - 1) -= x[k] * factor_.col(k).segment(k + 1, n - k - 1);
  }
  for (Eigen::Index k = n - 1; k >= 0; --k) {
    if (pivot_[static_cast<std::size_t>(k)] != 0) {
      x[k] =
          (x[k] - factor_.col(k).segment(k + 1, n - k - 1).dot(x.segment(k + 1, n - k - 1))) / factor_(k, k);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
