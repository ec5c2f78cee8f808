#pragma once

#include <memory>

#include "softpoint/figure/figure_dynamics.h"
#include "softpoint/figure/integrator.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Motion of the prescribed joints, as smooth as the figure is to follow it: the dynamic ones feel its
// accelerations.
class SOFTPOINT_API PrescribedMotion {
 public:
  virtual ~PrescribedMotion();
  // Writes the numbers of the prescribed joints at `time` (s) and leaves all others alone. Allocates nothing.
  virtual void evaluate(double time, double* q, double* qd, double* qdd) const = 0;
};

// Moves one figure through time without torques, from a state and under gravity. A step allocates nothing.
class SOFTPOINT_API FigureStepper {
 public:
  FigureStepper(const FigureModel& model, FigureState state,
                Integrator integrator = Integrator::kRungeKutta4);
  ~FigureStepper();
  FigureStepper(FigureStepper&&) noexcept;
  FigureStepper& operator=(FigureStepper&&) noexcept;

  // Gravity, dynamic joints, readings. What is prescribed without a motion stands still.
  FigureDynamics& dynamics();
  const FigureDynamics& dynamics() const;
  // Kept by reference, null for none; taken on at the next step.
  void set_prescribed_motion(const PrescribedMotion* motion);

  const FigureState& state() const;
  void set_state(FigureState state);  // refused like by check_state()
  double time() const;                // s
  void set_time(double time);

  // By `dt` s, 0 < dt <= 1. A state that would not be finite is not taken over: false, and the step counts in
  // guard_fired().
  bool step(double dt);
  long long guard_fired() const;
  // Kinetic and potential energy of the present state, J.
  double energy();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
