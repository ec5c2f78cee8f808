#pragma once

#include <cstddef>

#include "softpoint/core/config.h"

// The `paper` mode on a grid, built once per instruction set and chosen at run time. This header and what the
// paper_kernels_*.cpp include must hold no inline function or template of the standard library or Eigen: the
// linker would merge a copy compiled for AVX into code that runs everywhere.
namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Arrays of a grid with a row of ghosts below and above and a column of them at the right of each row, which
// is also the left one of the next. Ghosts have no mass, no springs and finite places apart from each other.
template <class T>
struct PaperGrid {
  static constexpr int kFamilies = 4;  // springs to (i+1, j), (i, j+1), (i+1, j+1), (i-1, j+1)
  static constexpr int kRowArrays = 3 * kFamilies + 12;
  static constexpr std::ptrdiff_t kPadding = 64;  // elements after the last row that may be read and written

  T *x[3], *low[3], *v[3];             // places, what rounding took from them (single precision), velocities
  T *force[3], *air[3];                // N; m2
  const T* stiffness[kFamilies];       // N/m; 0 where there is no spring
  const T *slash, *backslash;          // of a cell: 1/6 at the one of its diagonals, 0 at the other
  const T* inverse_mass;               // 1/kg; 0 of ghosts
  const T* real;                       // 1; 0 of ghosts
  const T* real_column;                // the same along a row, and 0 to the end of the padding
  T rest[kFamilies];                   // m
  std::ptrdiff_t stride, rows, first;  // of point (0, 0)
  T compression_ratio, damping_time;
  T area_of_point;  // m2; 0: exact gradient of the volume
  T* scratch;       // 2 * kRowArrays * (stride + kPadding), zero at first
};

template <class T>
struct PaperStep {
  T h, gauge, drag_rate, friction;  // s, Pa, 1/s
  T gravity[3];                     // m/s2
  bool friction_by_forces;
};

struct PaperKernels {
  // Spring forces and the air's direction; returns the volume, m3.
  double (*forces_single)(const PaperGrid<float>& grid);
  double (*forces_double)(const PaperGrid<double>& grid);
  void (*accelerate_single)(const PaperGrid<float>& grid, const PaperStep<float>& step);
  void (*accelerate_double)(const PaperGrid<double>& grid, const PaperStep<double>& step);
  void (*move_single)(const PaperGrid<float>& grid, const PaperStep<float>& step);
  void (*move_double)(const PaperGrid<double>& grid, const PaperStep<double>& step);
};

// Null when this compiler or processor family has no such variant.
const PaperKernels* paper_kernels_baseline();
const PaperKernels* paper_kernels_avx2();
const PaperKernels* paper_kernels_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
