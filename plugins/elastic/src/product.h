#pragma once

#include "block_matrix.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A matrix in the precision of its products; what goes in and comes out is double. Column by column at
// least `padded_rows()` apart. Does not allocate once reserve(n) was called.
class Product {
 public:
  Product() = default;
  Product(const Kernels& kernels, const Eigen::Ref<const Eigen::MatrixXd>& matrix, bool single)
      : kernels_(&kernels), single_(single) {
    if (single) {
      floats_ = BlockMatrix<float>(kernels, matrix);
    } else {
      doubles_ = BlockMatrix<double>(kernels, matrix);
    }
  }

  Eigen::Index depth() const { return single_ ? floats_.depth() : doubles_.depth(); }
  Eigen::Index padded_rows() const { return single_ ? floats_.padded_rows() : doubles_.padded_rows(); }
  // Numbers of scratch that multiply() wants for n columns: 0 in double precision.
  std::size_t scratch(Eigen::Index n) const {
    return single_ ? static_cast<std::size_t>(n * (floats_.depth() + floats_.padded_rows())) : 0;
  }

  // c (padded_rows x n) = matrix b (depth x n).
  void multiply(const double* b, Eigen::Index n, double* c, float* scratch) const {
    if (!single_) {
      doubles_.multiply(b, n, c);
      return;
    }
    kernels_->to_double(multiply_single(b, n, scratch), n * floats_.padded_rows(), c);
  }
  // The product as it comes out in single precision, inside `scratch`; null in double precision.
  const float* multiply_single(const double* b, Eigen::Index n, float* scratch) const {
    if (!single_) return nullptr;
    float* const in = scratch;
    float* const out = scratch + n * floats_.depth();
    kernels_->to_single(b, n * floats_.depth(), in);
    floats_.multiply(in, n, out);
    return out;
  }

  const BlockMatrix<float>& floats() const { return floats_; }
  const BlockMatrix<double>& doubles() const { return doubles_; }

 private:
  const Kernels* kernels_ = nullptr;
  bool single_ = false;
  BlockMatrix<float> floats_;
  BlockMatrix<double> doubles_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
