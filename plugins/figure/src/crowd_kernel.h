#pragma once

#include "lane_body.h"

// No standard library here: kernels built for other instruction sets include it.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// One block of a crowd: as many figures as a pack has lanes. Number k of the figure in lane l stands at
// [k * lanes + l]; all of it aligned to 64 bytes.
struct CrowdBlock {
  const LaneStep* steps;
  const LaneBody<double>* bodies;
  int count;  // of bodies
  int slots;
  const double* gravity;  // 3, m/s2
  const double* q;
  const double* qd;
  const double* tau;
  double* qdd;   // out
  double* work;  // scratch: `slot_size` doubles a slot, then `work_size` a body, then `ball_size` a ball
};

struct CrowdKernel {
  int lanes;
  int slot_size, work_size, ball_size;  // doubles
  void (*forward)(const CrowdBlock& block);
};

CrowdKernel crowd_kernel_baseline();
CrowdKernel crowd_kernel_avx2();
CrowdKernel crowd_kernel_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
