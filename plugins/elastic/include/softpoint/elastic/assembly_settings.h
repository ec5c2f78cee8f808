#pragma once

#include "softpoint/core/config.h"
#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// How the joining surfaces find their place.
enum class JointMethod {
  kEquilibrium,  // quasi-Newton steps through the stiffness factored at rest: fast and as exact as asked for
  kRichardson,   // the paper's equation (4), dx = kappa (-F1 - F2), a given number of times
};

// How large displacements of the ends are handed on to the joints before they are solved.
enum class Predictor {
  kAutomatic,          // inverse kinematics for ends that move far within a step, else none
  kInverseKinematics,  // always
  kNone,               // joints begin where they were
};

// The accuracy dial of joined parts. Defaults are the knee of time against error.
struct AssemblySettings {
  JointMethod method = JointMethod::kEquilibrium;
  // Joints are in balance when what is left over is below this part of the joint forces, 1e-14 to 1.
  double tolerance = 1e-4;
  // A solve, 0 to 100000; each multiplies every segment once or twice. 0: joints are carried along by what
  // holds them, nothing is balanced, and forces are found only when they are asked for.
  int max_iterations = 16;
  double kappa = 0;  // m/N of (4); 0 takes half the limit of convergence
  Predictor predictor = Predictor::kAutomatic;
  int ik_sweeps = 10;            // of cyclic coordinate descent, 0 to 1000
  bool single_precision = true;  // products in float, 1e-7 of the forces; everything else stays double
  InstructionSet max_instruction_set = InstructionSet::kAvx512;  // none beyond it is used
  // Strain of joining surfaces by rotation vectors, and the bow of the middle line: parts that bend or twist
  // far answer as shorter ones would. Twice the time of a solve.
  bool surface_turns = false;

  // Balance to 1e-10, products in double, turns of joining surfaces without limit.
  static AssemblySettings exact() {
    AssemblySettings s;
    s.tolerance = 5e-11;
    s.max_iterations = 1000;
    s.single_precision = false;
    s.surface_turns = true;
    return s;
  }
  // At most so many iterations, whatever is left over.
  static AssemblySettings budget(int iterations) {
    AssemblySettings s;
    s.tolerance = 1e-14;
    s.max_iterations = iterations;
    return s;
  }
};
// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const AssemblySettings& settings);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
