#pragma once

#include <span>

#include "rigid_state.h"
#include "softpoint/core/deformable_system.h"
#include "touched_points.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A point of a deformable held at a target (DeformableSystem::grab).
struct Handle {
  HandleId id = 0;
  int body = 0;
  int point = 0;
  Vec3 target = Vec3::Zero();   // m
  double max_force = 0;         // N
  Vec3 impulse = Vec3::Zero();  // N s on the body over the substep
  bool unreached = false;       // the point was not brought to the target although force is left
};

// The handles' part of the Gauss-Seidel sweeps: brings each held point to its target at the end of the step,
// as far as its force allows.
class HandleSolver {
 public:
  // Measures from the free motion of the bodies; applies the impulses that the handles hold already.
  void prepare(std::span<Handle> handles, std::span<Deformable* const> bodies,
               std::span<TouchedPoints> touched, double dt);
  // One sweep; returns the largest distance of a held point from its target (m), where force is left.
  double sweep(std::span<Handle> handles, std::span<TouchedPoints> touched);

 private:
  struct Row {
    int local = 0;
    Mat3 inverse;              // N s per m
    Vec3 base = Vec3::Zero();  // m, free end minus target
  };

  double dt_ = 0;
  std::vector<Row> rows_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
