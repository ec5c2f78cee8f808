// The bare float product of N parts, by several kernels in one run: microseconds (best and median of many),
// GF/s, and the largest difference from double precision.
//   build/bin/batched_product [N]        (100 parts when not told)
#include "benchmarks/batched_product.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace softpoint::benchmarks {

// Slow and obvious, to judge the others by.
static void plain_product(const Product& shape, const float* a, const float* b, float* c) {
  for (int j = 0; j < shape.columns; ++j) {
    for (int i = 0; i < shape.rows; ++i) c[j * shape.stride + i] = 0.0f;
    for (int k = 0; k < shape.inner; ++k) {
      const float factor = b[j * shape.inner + k];
      for (int i = 0; i < shape.rows; ++i) c[j * shape.stride + i] += a[k * shape.stride + i] * factor;
    }
  }
}

std::vector<NamedKernel> product_kernels() {
  std::vector<NamedKernel> kernels = {
      {"plain loops, baseline instructions", 1, plain_product},
      {"Eigen, -O3 -march=native", 1, eigen_native_product},
      {"Eigen, padded to 256 rows", 256, eigen_native_product},
      {"elastic plugin", 32, our_product},
  };
#ifdef SOFTPOINT_HAVE_LIBXSMM
  kernels.push_back({"libxsmm", 1, libxsmm_product});
  kernels.push_back({"libxsmm, padded to 256 rows", 256, libxsmm_product});
#endif
  return kernels;
}

namespace {

struct Timing {
  double best, median, error;  // s, s, relative to the largest entry
};

Timing time_kernel(const NamedKernel& kernel, int rows, int inner, int columns) {
  Product shape = {(rows + kernel.row_multiple - 1) / kernel.row_multiple * kernel.row_multiple, inner,
                   columns};
  shape.stride = (shape.rows + 15) / 16 * 16;
  unsigned state = 1;
  const auto noise = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(static_cast<int>(state >> 8) - (1 << 23)) * 0x1p-23f;
  };
  // Aligned to cache lines, whatever the allocator does.
  std::vector<float> store(static_cast<std::size_t>(shape.stride) * (inner + columns) + inner * columns + 64);
  float* a = store.data();
  while (reinterpret_cast<std::uintptr_t>(a) % 64 != 0) ++a;
  float* c = a + shape.stride * inner;
  float* b = c + shape.stride * columns;
  for (int k = 0; k < inner; ++k) {
    for (int i = 0; i < rows; ++i) a[k * shape.stride + i] = noise();
  }
  for (int i = 0; i < inner * columns; ++i) b[i] = noise();
  std::vector<double> seconds;
  const auto begun = std::chrono::steady_clock::now();
  std::chrono::duration<double> all{};
  while (seconds.size() < 2000 && (all.count() < 1.0 || seconds.size() < 50)) {
    const auto start = std::chrono::steady_clock::now();
    kernel.run(shape, a, b, c);
    const auto end = std::chrono::steady_clock::now();
    seconds.push_back(std::chrono::duration<double>(end - start).count());
    all = end - begun;
  }
  double error = 0.0, largest = 0.0;
  for (int j = 0; j < columns; ++j) {
    for (int i = 0; i < rows; ++i) {
      double exact = 0.0;
      for (int k = 0; k < inner; ++k)
        exact += static_cast<double>(a[k * shape.stride + i]) * b[j * inner + k];
      largest = std::max(largest, std::abs(exact));
      const double off = std::abs(exact - c[j * shape.stride + i]);
      if (!(off <= error)) error = off;
    }
  }
  std::sort(seconds.begin(), seconds.end());
  return {seconds.front(), seconds[seconds.size() / 2], error / largest};
}

}  // namespace
}  // namespace softpoint::benchmarks

int main(int argc, char** argv) {
  using namespace softpoint::benchmarks;
  const int columns = argc > 1 ? std::atoi(argv[1]) : 100;
  if (columns < 1 || columns > 100000) {
    std::fprintf(stderr, "usage: batched_product [N], N from 1 to 100000\n");
    return 2;
  }
  constexpr int kRows = 246, kInner = 102;
  std::printf("%d x %d times %d x %d, float; Eigen native: %s; elastic plugin: %s\n", kRows, kInner, kInner,
              columns, eigen_native_instructions(), our_instructions());
  std::printf("%-38s %9s %9s %8s %10s\n", "kernel", "best us", "median us", "GF/s", "error");
  int failures = 0;
  for (const NamedKernel& kernel : product_kernels()) {
    const Timing t = time_kernel(kernel, kRows, kInner, columns);
    std::printf("%-38s %9.2f %9.2f %8.1f %10.2e\n", kernel.name, 1e6 * t.best, 1e6 * t.median,
                2e-9 * kRows * kInner * columns / t.best, t.error);
    if (!(t.error < 1e-5)) ++failures;
  }
  if (failures > 0) std::printf("%d kernels gave a wrong product\n", failures);
  return failures > 0 ? 1 : 0;
}
