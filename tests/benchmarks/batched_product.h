#pragma once

#include <vector>

// C = A B in single precision, column-major: A is rows x inner (the condensed block of the elastic-character
// paper's cylinder: 246 x 102), B has one column a part. Kernels may have A laid out in their own way, once.
namespace softpoint::benchmarks {

struct Product {
  int rows, inner, columns;
  int stride = 0;  // of the columns of A and C, at least rows; B's stride is inner
};

using ProductKernel = void (*)(const Product& shape, const float* a, const float* b, float* c);

struct NamedKernel {
  const char* name;
  int row_multiple;  // A and C are padded with zeros to this multiple of rows
  ProductKernel run;
};

void eigen_native_product(const Product& shape, const float* a, const float* b, float* c);
const char* eigen_native_instructions();

// The elastic plugin's own kernel, for the best instruction set that SOFTPOINT_MAX_ISA allows.
void our_product(const Product& shape, const float* a, const float* b, float* c);
const char* our_instructions();

#ifdef SOFTPOINT_HAVE_LIBXSMM
void libxsmm_product(const Product& shape, const float* a, const float* b, float* c);
#endif

// Further kernels are entered in the list in batched_product.cpp.
std::vector<NamedKernel> product_kernels();

}  // namespace softpoint::benchmarks
