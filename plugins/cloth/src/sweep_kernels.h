#pragma once

#include "sweep_data.h"

// The heavy loops, built once per instruction set and chosen at run time. This header and what the
// kernels_*.cpp include must hold no inline function or template of the standard library or Eigen: the linker
// would merge a copy compiled for AVX into code that runs everywhere.
namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Per pocket, over the free points of a colour that do not touch (equation (6) of doc/solver.md).
struct PocketSums {
  double stiff = 0;  // s = sum G . b
  double lag = 0;    // sum G . a
  double fixed = 0;  // sum G . dx of touching points
};

template <class T>
struct SweepKernels {
  // Dampers: damper * length at the start of the small step, into springs; equation (3).
  void (*measure_dampers)(const SweepData<T>&, const ColourPlan&, T* springs);
  // g, H, a, and where there is air G, b and the sums of `pockets`; equations (2) to (5).
  void (*gather)(const SweepData<T>&, const ColourPlan&, bool air, PocketSums* sums);
  // Moves with the gauge pressures given, contact included, into dx; the sums anew, by the touch found.
  // Returns how many points changed between touching and not; equations (7) to (9).
  int (*move)(const SweepData<T>&, const ColourPlan&, const double* gauges, PocketSums* sums);
  // x += dx. Returns the largest square of a move (m2); adds sum G . dx to `change` by pocket.
  double (*commit)(const SweepData<T>&, const ColourPlan&, bool air, double* change);
  // Into b what pushes each point that a coarse correction may carry along: minus the gradient, air at the
  // gauge pressures (or null) included; of a sliding point within its plane, friction included; 0 for those
  // held, stuck or about to be.
  void (*push)(const SweepData<T>&, const ColourPlan&, const double* gauges);
  // The same push as it is now, times the moves dx, summed (J).
  double (*push_along)(const SweepData<T>&, const ColourPlan&, const double* gauges);
  // Adds sum x . G over the colour, by pocket (m3).
  void (*volume)(const SweepData<T>&, const ColourPlan&, double* volumes);
  // Energy of springs and bending, half of each spring's for each end (J).
  double (*elastic_energy)(const SweepData<T>&, const ColourPlan&);
};

struct SweepKernelTable {
  int lanes_single, lanes_double;
  SweepKernels<float> single;
  SweepKernels<double> dual;
};

// Null when this compiler or processor family has no such variant.
const SweepKernelTable* sweep_kernels_baseline();
const SweepKernelTable* sweep_kernels_avx2();
const SweepKernelTable* sweep_kernels_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
