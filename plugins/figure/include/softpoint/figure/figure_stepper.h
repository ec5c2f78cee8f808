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

// A joint that met its range or left it.
struct LimitEvent {
  double time = 0;  // s
  int link = 0;
  int side = 0;         // -1 lower, +1 upper
  bool impact = false;  // else release
  bool swing = false;   // of a ball: its cone, else its twist
};

// A point of a link that is held where it is.
struct PinnedPoint {
  int link = 0;
  Vec3 point = Vec3::Zero();  // m, in the link's frame
  Vec3 place = Vec3::Zero();  // m, world
};

// What keeping the ranges has cost and come to.
struct LimitCounts {
  long long impacts = 0, releases = 0;
  long long passes = 0;      // of the dynamics to find who leans on a stop
  long long resteps = 0;     // steps taken again to locate an event
  long long capped = 0;      // steps of more than 1000 parts, the rest of which stopped joints at its end
  long long wrong_sign = 0;  // kPaper: joints held by a torque that pulls towards the stop
  long long taut = 0;        // steps that pins stopped dead: a chain drawn taut, legs stretched to the full
  long long unfinished = 0;  // searches that did not come to an end (kPaper: steps)
};

// Moves one figure through time without torques, from a state and under gravity. A step allocates nothing.
class SOFTPOINT_API FigureStepper {
 public:
  FigureStepper(const FigureModel& model, FigureState state,
                Integrator integrator = Integrator::kRungeKutta4);
  ~FigureStepper();
  FigureStepper(FigureStepper&&) noexcept;
  FigureStepper& operator=(FigureStepper&&) noexcept;

  // Gravity and readings; its dynamic joints are set by the stepper.
  FigureDynamics& dynamics();
  const FigureDynamics& dynamics() const;
  // Which links' joints are dynamic, one flag a link; all to begin with. What is prescribed without a motion
  // stands still.
  void set_dynamic(std::span<const bool> links);

  // Refused: kPaper with another integrator, kExact with the paper's; kExact of balls with cones with
  // kVariational; a state outside the ranges.
  void set_limits(LimitMode mode);
  LimitMode limits() const;
  // Points that stay where they are while the rest moves: loops are closed by forces found with the
  // dynamics. What could not be kept at all, a point that no dynamic joint moves, is left alone. Rates
  // against them are stopped at once. Refused: points farther than 1e-6 m from their places, kVariational,
  // kPaper limits.
  void set_pins(std::vector<PinnedPoint> pins);
  // What each pin gave in the last step, N s on the figure.
  std::span<const Vec3> pin_impulses() const;
  // The paper's friction of step (7): the factor, 0 to 1, by which a link's joint slows in `reference_dt` s.
  void set_paper_friction(int link, double factor, double reference_dt = 1.0 / 30);
  // Events of the last step, in order; at most 64 are kept.
  std::span<const LimitEvent> events() const;
  const LimitCounts& limit_counts() const;
  // Kept by reference, null for none; taken on at the next step.
  void set_prescribed_motion(const PrescribedMotion* motion);

  const FigureState& state() const;
  void set_state(const FigureState& state);  // refused like by check_state(); allocates nothing
  double time() const;                       // s
  void set_time(double time);

  // By `dt` s, 0 < dt <= 1. A state that would not be finite is not taken over: false, and the step counts in
  // guard_fired().
  bool step(double dt);
  long long guard_fired() const;
  // Parts of steps of kVariational for which no end was found: taken by kRungeKutta4.
  long long unsolved() const;
  // Parts that steps of kRungeKutta4 and kDormandPrince were taken in because a joint turned by more than
  // half a radian: light limbs of frictionless figures get that fast.
  long long parts() const;
  // Kinetic and potential energy of the present state, J.
  double energy();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
