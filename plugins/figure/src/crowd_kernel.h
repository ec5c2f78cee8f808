#pragma once

#include "tree_body.h"

// No standard library here: kernels built for other instruction sets include it.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// One block of a crowd: as many figures as a pack has lanes. Number k of the figure in lane l stands at
// [k * lanes + l]; all of it aligned to 64 bytes.
struct CrowdBlock {
  const TreeBody* bodies;
  int count;              // of bodies
  const double* gravity;  // 3, m/s2
  const double* q;
  const double* qd;
  double* torque;  // in: of the joints; out: less their friction
  double* qdd;     // out
  double* work;    // scratch: `work_size` doubles a body, then `ball_size` a ball
};

struct CrowdKernel {
  int lanes;
  int work_size, ball_size;  // doubles
  void (*forward)(const CrowdBlock& block);
};

CrowdKernel crowd_kernel_baseline();
CrowdKernel crowd_kernel_avx2();
CrowdKernel crowd_kernel_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
