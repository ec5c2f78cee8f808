#pragma once

#include <cstddef>

#include "softpoint/core/config.h"

// The two heavy kernels, built once per instruction set and chosen at run time. This header and what the
// kernels_*.cpp include must hold no inline function or template of the standard library or Eigen: the
// linker would merge a copy compiled for AVX into code that runs everywhere.
namespace softpoint::inline SOFTPOINT_ABI::elastic {

// What layer_potentials wants to know of a triangle (v0, v1, v2), one row of doubles each.
enum PanelField {
  kFieldVertex = 0,      // 9: v0, v1, v2
  kFieldNormal = 9,      // 3: n
  kFieldTangent = 12,    // 9: tau_k, unit vector from v_k to v_k+1
  kFieldConormal = 21,   // 9: m_k = tau_k x n
  kFieldLength = 30,     // 3: |v_k+1 - v_k|
  kFieldGradient = 33,   // 6: g_0, g_1
  kFieldTwiceArea = 39,  // 1
  kPanelFields = 40
};

// What it returns, summed over the points with their weights.
enum PanelIntegral {
  kSingle = 0,  // int 1/R
  kTensor = 1,  // 6: int r r^T / R^3, xx yy zz xy xz yz
  kDouble = 7,  // 3: int d/dn(1/R) phi_a
  kPanelIntegrals = 10
};

struct Kernels {
  int lanes;
  std::ptrdiff_t scratch;  // doubles that the dense kernels want

  // Integrals over `lanes` triangles, seen from `count` points (x, y, z, weight). Field k of lane i is
  // fields[k * stride + i]; integral k of lane i goes to out[k * lanes + i]. Equations (6) to (10) of
  // doc/boundary_elements.md.
  void (*layer_potentials)(const double* fields, std::ptrdiff_t stride, const double* points, int count,
                           double* out);

  // Column-major throughout; only the lower triangles of a, l and s are read or written, except that
  // blocks on the diagonal of `a` and `s` may leave anything above it.
  // a = L L^T in place; false when `a` (n x n) is not positive definite.
  bool (*cholesky)(double* a, std::ptrdiff_t n, std::ptrdiff_t lda, double* scratch);
  // x <- x L^-T and x <- x L^-1, x being m x n.
  void (*divide_transposed)(double* x, std::ptrdiff_t m, std::ptrdiff_t ldx, const double* l,
                            std::ptrdiff_t n, std::ptrdiff_t ldl, double* scratch);
  void (*divide)(double* x, std::ptrdiff_t m, std::ptrdiff_t ldx, const double* l, std::ptrdiff_t n,
                 std::ptrdiff_t ldl, double* scratch);
  // s += x x^T, s being m x m, x being m x n.
  void (*add_square)(double* s, std::ptrdiff_t m, std::ptrdiff_t lds, const double* x, std::ptrdiff_t n,
                     std::ptrdiff_t ldx, double* scratch);

  // c += sign a b^T, c being m x n, a m x k and b n x k; from row to row and from column to column of a and b
  // it is so far, which transposes them at will.
  void (*add_product)(std::ptrdiff_t m, std::ptrdiff_t n, std::ptrdiff_t k, double sign, const double* a,
                      std::ptrdiff_t a_row, std::ptrdiff_t a_column, const double* b, std::ptrdiff_t b_row,
                      std::ptrdiff_t b_column, double* c, std::ptrdiff_t ldc, double* scratch);

  // c = a b: `a` in `strips` strips of strip_rows rows each, depth-major inside a strip, padded with zeros; b
  // (depth x n) and c (strips * strip_rows x n) column-major.
  std::ptrdiff_t strip_rows_single, strip_rows_double;
  void (*product_single)(const float* a, std::ptrdiff_t strips, std::ptrdiff_t depth, const float* b,
                         std::ptrdiff_t ldb, std::ptrdiff_t n, float* c, std::ptrdiff_t ldc);
  void (*product_double)(const double* a, std::ptrdiff_t strips, std::ptrdiff_t depth, const double* b,
                         std::ptrdiff_t ldb, std::ptrdiff_t n, double* c, std::ptrdiff_t ldc);

  // y = a x, `a` symmetric (n x n): laid out by pack_symmetric() with x and y padded, zeros in x; or
  // column-major, of which the lower triangle is read.
  std::ptrdiff_t symmetric_strip, symmetric_panel;
  void (*packed_symmetric_single)(const float* a, std::ptrdiff_t n, const float* x, float* y);
  void (*symmetric_double)(const double* a, std::ptrdiff_t n, std::ptrdiff_t lda, const double* x, double* y);

  // Small sums and turns of one segment's n points, axis-major; matrices column-major (segment_frames-inl.h).
  void (*sum_moments)(const double* p, const double* arms, std::ptrdiff_t n, double* out);
  void (*turn_back)(const double* p, const double* mean, const double* r, const double* arms,
                    std::ptrdiff_t n, double* d);
  void (*sum_forces)(const double* d, const double* f, const double* arms, std::ptrdiff_t n, double* out);
  void (*turn_forces)(double* f, const double* a, const double* r, const double* arms, std::ptrdiff_t n);
  void (*place_points)(const double* rest, const double* u, const double* r, const double* at,
                       std::ptrdiff_t n, double* out);
  void (*place_single_points)(const double* rest, const float* u, const double* r, const double* at,
                              std::ptrdiff_t n, double* out);
  void (*to_single)(const double* from, std::ptrdiff_t n, float* to);
  void (*to_double)(const float* from, std::ptrdiff_t n, double* to);
};

// Null when this compiler or processor family has no such variant.
const Kernels* kernels_baseline();
const Kernels* kernels_avx2();
const Kernels* kernels_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
