#pragma once

#include "softpoint/core/config.h"

// Explicit small steps of a grid, by vector instructions: see doc/solver.md. Plain data and a table of
// kernels, for the reason given in sweep_kernels.h.
namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Where a point is: in single by whole numbers of a small length, so that neighbours' differences lose no
// digits however small the steps.
template <class T>
struct MarchPlace {
  using Type = double;
};
template <>
struct MarchPlace<float> {
  using Type = int;
};

// Row after row, `stride` numbers each (a multiple of the table's lanes and more than there are columns),
// zeros behind the last point of a row and a row of zeros before the first and after the last. What is
// `turned` has column after column, `turned_stride` numbers each.
inline constexpr int kMarchLanes = 16;  // at most

template <class T>
struct MarchData {
  using Place = typename MarchPlace<T>::Type;
  static constexpr int kFamilies = 4;    // to (i + 1, j), (i, j + 1), (i + 1, j + 1), (i - 1, j + 1)
  static constexpr int kRowArrays = 15;  // of scratch: springs and cells as the row below sees them
  static constexpr int kPadding = 32;    // of a row in scratch

  long columns, rows, stride, turned_stride;
  T unit, per_unit;  // of places, m; its inverse
  Place* x[3];
  T* v[3];               // m/s
  T* f[3];               // changes of v in a step
  T* g[3];               // dV/dx, m2
  T* c[3];               // contact forces of all steps since they were cleared, N
  T* touch;              // as in SweepData, of the last step
  T* length[kFamilies];  // of springs, in units, of the last step
  // What is only read is most often the same in all rows but the first and the last; then row 1 is read
  // for all of them, which stays near the processor.
  bool points_alike, springs_alike;
  const T *mass, *inverse_mass;
  const T* acceleration[3];       // of constant forces
  const T* stiffness[kFamilies];  // N a unit
  T rest[kFamilies];              // units
  const Place* foot[3];           // on the contact plane
  const T* normal[3];
  const T *friction, *adhesion;
  // abc, acd, abd and bcd of a cell a (i, j), b (i + 1, j), c (i + 1, j + 1), d (i, j + 1): +-1/6 in the
  // pocket, else 0, times the square of a unit in m
  const T* faces[4];
  bool crossed;                          // there are faces abd or bcd
  const T* rim[3];                       // what rims add to dV/dx
  T *lower[3], *pivot[3];                // factors along columns, inverses of their pivots
  T *turned_lower[3], *turned_pivot[3];  // and along rows
  T* turned[3];
  T* cells[3];  // scratch
  T* scratch;   // 2 kRowArrays rows of stride + kPadding
  T compression, damping_time, drag_rate;
};

// What an explicit step does about dV/dx: there is none, it stays, it is found anew.
enum class MarchAir { kNone, kKept, kMeasured };
// What tells dampers how fast springs stretch: the velocities, or the lengths of the step before.
enum class MarchRate { kVelocity, kLength };

template <class T>
struct MarchKernels {
  // Changes of v in a step of h by springs, dampers, weight, air at `gauge` and contact, into f.
  void (*push)(const MarchData<T>&, MarchAir air, MarchRate rate, T gauge, T h);
  // What keeps the steps stable: factors of (1 + D_rows) and (1 + D_columns/4), D made of share * stiffness/mass of the springs as they
  // lie.
  void (*factor)(const MarchData<T>&, T share);
  // f <- A (1 + D_rows)^-1 A f, A = (1 + D_columns/4)^-1; v += f, x += h v. Returns the sum of g . v.
  double (*move)(const MarchData<T>&, T h);
};

struct MarchKernelTable {
  MarchKernels<float> single;
  MarchKernels<double> dual;
  int bytes;  // of a vector
};

const MarchKernelTable* march_kernels_baseline();
const MarchKernelTable* march_kernels_avx2();
const MarchKernelTable* march_kernels_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
