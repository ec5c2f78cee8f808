#include <libxsmm.h>

#include "benchmarks/batched_product.h"

namespace softpoint::benchmarks {

// The kernel is made at the first call for a shape.
void libxsmm_product(const Product& shape, const float* a, const float* b, float* c) {
  static libxsmm_smmfunction kernel = nullptr;
  static Product made = {0, 0, 0, 0};
  if (made.rows != shape.rows || made.columns != shape.columns || made.inner != shape.inner ||
      made.stride != shape.stride) {
    const int lda = shape.stride, ldb = shape.inner, ldc = shape.stride;
    const float alpha = 1.0f, beta = 0.0f;
    kernel = libxsmm_smmdispatch(shape.rows, shape.columns, shape.inner, &lda, &ldb, &ldc, &alpha, &beta,
                                 nullptr, nullptr);
    made = shape;
  }
  if (kernel != nullptr) kernel(a, b, c);
}

}  // namespace softpoint::benchmarks
