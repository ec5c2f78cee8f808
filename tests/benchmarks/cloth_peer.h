#pragma once

#include <vector>

#include "support/cloth_run.h"

namespace softpoint::benchmarks {

// A lift, and the CPU time (s) of each of its frames.
struct TimedRun {
  cloth::ClothRun run;
  std::vector<double> seconds;
};

// The task by Bullet's btSoftBody over a plane, dry (its pressure gives NaN on an open sheet): links along
// warp, weft and both diagonals, so many position iterations, the step of the world a frame over `substeps`.
TimedRun bullet_lift(const cloth::LiftTask& task, int iterations, int substeps);

}  // namespace softpoint::benchmarks
