#pragma once

#include <span>

#include "handle.h"
#include "pin_block.h"
#include "rigid_state.h"
#include "touched_points.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The handles' part of the Gauss-Seidel sweeps: brings each held point to its target at the end of the step,
// as far as its force allows. Handles of unlimited force are solved together, by the bodies and objects they
// tie.
class HandleSolver {
 public:
  // Forgets the factored systems of the last substep.
  void begin_step() { factored_ = false; }
  // Measures from the free motion of the bodies; applies the impulses that the handles hold already.
  void prepare(std::span<Handle> handles, std::span<Deformable* const> bodies,
               std::span<TouchedPoints> touched, RigidStates& rigid, double dt);
  // One sweep; returns the largest distance of a held point from its target (m), where force is left.
  double sweep(std::span<Handle> handles, std::span<TouchedPoints> touched, RigidStates& rigid);

 private:
  struct Row {
    int local = 0;
    int group = -1;            // of handles solved together, -1 for a limited one
    Mat3 inverse;              // N s per m, of a limited one
    Vec3 free = Vec3::Zero();  // m, free end of the point
  };
  struct Block {
    PinBlock system;
    std::vector<std::size_t> members;  // indices of handles
    std::vector<Vec3> values;
  };

  Mat3 coupling(const Handle& a, const Row& row_a, const Handle& b, const Row& row_b,
                std::span<const TouchedPoints> touched, const RigidStates& rigid) const;
  void group(std::span<const Handle> handles, std::size_t bodies, const RigidStates& rigid);
  void factorize(std::span<const Handle> handles, std::span<const TouchedPoints> touched,
                 const RigidStates& rigid);
  Vec3 error(const Handle& handle, const Row& row, std::span<const TouchedPoints> touched,
             const RigidStates& rigid) const;
  void apply(const Handle& handle, const Row& row, const Vec3& impulse, std::span<TouchedPoints> touched,
             RigidStates& rigid) const;

  double dt_ = 0;
  bool factored_ = false;
  std::vector<Row> rows_;
  std::vector<int> joined_;  // body -> a body of the same group
  std::vector<Block> blocks_;
  std::size_t used_ = 0;  // blocks
};

}  // namespace softpoint::inline SOFTPOINT_ABI
