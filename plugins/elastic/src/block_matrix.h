#pragma once

#include <Eigen/Core>

#include <vector>

#include "kernels.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A matrix laid out once for the batched product of the instruction set in use.
template <class Real>
class BlockMatrix {
 public:
  BlockMatrix() = default;
  BlockMatrix(const Kernels& kernels, const Eigen::Ref<const Eigen::MatrixXd>& matrix) : kernels_(&kernels) {
    strip_ = sizeof(Real) == sizeof(float) ? kernels.strip_rows_single : kernels.strip_rows_double;
    rows_ = matrix.rows();
    depth_ = matrix.cols();
    strips_ = (rows_ + strip_ - 1) / strip_;
    packed_.assign(static_cast<std::size_t>(strips_ * strip_ * depth_), Real(0));
    for (Eigen::Index p = 0; p < depth_; ++p) {
      for (Eigen::Index i = 0; i < rows_; ++i) {
        packed_[static_cast<std::size_t>((i / strip_ * depth_ + p) * strip_ + i % strip_)] =
            static_cast<Real>(matrix(i, p));
      }
    }
  }

  Eigen::Index rows() const { return rows_; }
  Eigen::Index depth() const { return depth_; }
  // Rows of the result, rounded up: the least leading dimension of `c`.
  Eigen::Index padded_rows() const { return strips_ * strip_; }

  // c (padded_rows x n) = this b (depth x n), both column-major without gaps but for `c`'s padding.
  void multiply(const Real* b, Eigen::Index n, Real* c) const {
    if constexpr (sizeof(Real) == sizeof(float)) {
      kernels_->product_single(packed_.data(), strips_, depth_, b, depth_, n, c, padded_rows());
    } else {
      kernels_->product_double(packed_.data(), strips_, depth_, b, depth_, n, c, padded_rows());
    }
  }

 private:
  const Kernels* kernels_ = nullptr;
  Eigen::Index strip_ = 1, rows_ = 0, depth_ = 0, strips_ = 0;
  std::vector<Real> packed_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
