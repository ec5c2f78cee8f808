// Compiled for the machine it is built on.
#include <Eigen/Core>

#include "benchmarks/batched_product.h"

namespace softpoint::benchmarks {

void eigen_native_product(const Product& shape, const float* a, const float* b, float* c) {
  using Matrix = Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>>;
  const Matrix left(a, shape.rows, shape.inner, Eigen::OuterStride<>(shape.stride));
  const Matrix right(b, shape.inner, shape.columns, Eigen::OuterStride<>(shape.inner));
  Eigen::Map<Eigen::MatrixXf, 0, Eigen::OuterStride<>> result(c, shape.rows, shape.columns,
                                                              Eigen::OuterStride<>(shape.stride));
  result.noalias() = left * right;
}

const char* eigen_native_instructions() { return Eigen::SimdInstructionSetsInUse(); }

}  // namespace softpoint::benchmarks
