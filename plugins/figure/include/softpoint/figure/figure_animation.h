#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "softpoint/figure/figure_clip.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

struct AnimationSettings {
  double frame_time = 1.0 / 30;  // s
  int substeps = 1;              // of the dynamics, a frame
  Integrator integrator = Integrator::kRungeKutta4;
  LimitMode limits = LimitMode::kExact;  // of the dynamic joints
  Vec3 gravity{0, 0, -9.81};             // m/s2
  double friction = 0.8;                 // Coulomb's, of kContact
  // The paper's friction of step (7): link and factor of the rate in 1/30 s. Integrators other than the paper's
  // take it as viscous friction with which the joint alone slows by that factor.
  std::vector<std::pair<int, double>> paper_friction;
};

// The figure left the ground or came to it.
struct PlaceEvent {
  enum class Kind { kTakeOff, kLanding };
  Kind kind = Kind::kTakeOff;
  double time = 0;  // s, of the first state after it
  int link = 0;     // that was held, or is from now on
};

// What evaluating has cost since construction.
struct AnimationCounts {
  long long evaluations = 0;
  long long dynamic_steps = 0;         // frames of independent dynamic pieces that were simulated
  long long reused_steps = 0;          // the same, taken over because nothing they depend on had changed
  long long forward_calls = 0;         // forward dynamics
  long long boxes_overlapping = 0;     // pairs that the broad phase let through
  long long narrow_tests = 0;          // of two shapes
  Vec3 impulse = Vec3::Zero();         // N s, of kContact on the figure, and
  Vec3 impulse_moment = Vec3::Zero();  // N m s, about the world's origin
  double feet_missed = 0;              // m, farthest that a foot of kFeet was from its place: out of reach
  long long guard_fired = 0;           // steps that would not have been finite and left a joint as it was
};

// A whole clip, frame by frame: keyed joints by their splines, dynamic ones by zero-torque dynamics that feel
// the keyed ones' accelerations and that of the base. Prescribed joints cut the figure into pieces that are
// simulated by themselves; each frame of a piece remembers what it was made of, and after an edit only those
// frames are simulated again for which that has changed.
class SOFTPOINT_API FigureAnimation {
 public:
  // Throws Error like check_clip(), and for settings out of range.
  FigureAnimation(const FigureModel& model, FigureClip clip, AnimationSettings settings = {});
  ~FigureAnimation();
  FigureAnimation(FigureAnimation&&) noexcept;
  FigureAnimation& operator=(FigureAnimation&&) noexcept;

  const FigureModel& model() const;
  const FigureClip& clip() const;
  const AnimationSettings& settings() const;
  // Edits; refused ones change nothing. evaluate() takes them in.
  void set_key(int track, int key, JointKey value);
  void set_clip(FigureClip clip);

  // Makes all frames. Throws Error where a dynamic joint would begin outside its range.
  void evaluate();

  int frame_count() const;  // the last one is at the clip's end or just before
  const FigureState& frame(int index) const;
  // The state at any time (s): frames, and between them cubics that meet their positions and rates.
  void sample(double time, FigureState& to) const;

  // In order of time.
  const std::vector<PlaceEvent>& events() const;
  const AnimationCounts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
