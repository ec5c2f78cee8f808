#pragma once

#include <memory>
#include <span>

#include "softpoint/core/instruction_set.h"
#include "softpoint/figure/figure_model.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Accelerations of many figures of one model at once, each in a lane of the processor's vectors: the
// articulated-body algorithm of FigureDynamics, all joints dynamic, from the same source. The instruction set
// is chosen at run time. Keeps its storage; calls allocate nothing.
class SOFTPOINT_API FigureCrowd {
 public:
  // All at rest. Throws Error unless 1 <= figures <= 1,000,000.
  FigureCrowd(const FigureModel& model, int figures, InstructionSet limit = InstructionSet::kAvx512);
  ~FigureCrowd();
  FigureCrowd(FigureCrowd&&) noexcept;
  FigureCrowd& operator=(FigureCrowd&&) noexcept;

  int size() const;
  int lanes() const;  // figures a vector
  InstructionSet instruction_set() const;
  void set_gravity(const Vec3& gravity);  // m/s2

  // Arrays as FigureModel says. Not checked but for sizes: check_state() does.
  void set_state(int figure, std::span<const double> q, std::span<const double> qd);
  void set_torque(int figure, std::span<const double> tau);  // N m, N; zero to begin with
  // Accelerations for the torques less the joints' viscous friction.
  void forward();
  void acceleration(int figure, std::span<double> qdd) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
