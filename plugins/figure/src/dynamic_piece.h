#pragma once

#include <optional>
#include <vector>

#include "link_chain.h"
#include "softpoint/figure/figure_animation.h"
#include "softpoint/figure/figure_stepper.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where the figure's base goes during one frame.
struct BaseRule {
  const LinkChain* pinned = nullptr;  // null: by its own keys
  Vec3 point = Vec3::Zero();          // m, of the pinned link, in its frame
  Vec3 place = Vec3::Zero();          // m, where that is held; or from where the base flies,
  bool flies = false;
  double time = 0;                                // s
  Vec3 rate = Vec3::Zero(), gain = Vec3::Zero();  // m/s, m/s2

  // Moves the base, whose turn is right already, so that the point is where it belongs.
  void apply(const FigureModel& model, double* q, double* qd, double* qdd) const;
  // Puts it where it flies.
  void fly(const FigureModel& model, double now, double* q, double* qd, double* qdd) const;
};

// The keyed joints at a time, with the base after them.
class KeyedMotion final : public PrescribedMotion {
 public:
  KeyedMotion(const FigureModel& model, const std::vector<std::optional<TrackSpline>>& splines)
      : model_(model), splines_(splines) {}
  void evaluate(double time, double* q, double* qd, double* qdd) const override;

  std::vector<int> links;  // that are read
  BaseRule base;

 private:
  const FigureModel& model_;
  const std::vector<std::optional<TrackSpline>>& splines_;
};

// The model with the ranges of some links' joints alone, and a state inside them.
FigureModel with_ranges_of(const FigureModel& model, const std::vector<int>& links);
FigureState state_inside(const FigureModel& model);
// With the settings' factors of the paper as viscous friction of those of the links that have one, where the
// integrator is not the paper's: a joint alone then slows by its factor in 1/30 s, whatever the step. The
// inertia that counts is that which the joint meets with all the links dynamic in the pose state_inside().
FigureModel with_friction_of(FigureModel model, const std::vector<int>& links,
                             const AnimationSettings& settings);

// Dynamic joints that depend on each other, simulated apart from all others. Remembers, frame by frame, what
// it was made of and what came out.
class DynamicPiece {
 public:
  DynamicPiece(const FigureModel& model, std::vector<int> links, const AnimationSettings& settings,
               const std::vector<std::optional<TrackSpline>>& splines);

  const std::vector<int>& links() const { return links_; }
  // Writes the piece's joints at `time` + `dt` into `next`. With `want_acceleration` their accelerations then
  // are kept for acceleration().
  void advance(std::size_t tick, double time, double dt, const BaseRule& base, const FigureState& from,
               bool want_acceleration, FigureState& next, AnimationCounts& counts);
  // Of a link's joint after the last frame that was asked for it.
  std::vector<double> acceleration(int link) const;

 private:
  struct Memory {
    std::vector<double> inputs, q, qd, qdd;
  };
  void simulate(double time, double dt, const FigureState& from, bool want_acceleration, Memory& memory,
                AnimationCounts& counts);

  FigureModel model_;  // with the ranges of this piece's joints alone
  std::vector<int> links_;
  std::vector<int> needed_;  // links whose state the piece depends on
  std::vector<char> is_dynamic_;
  int substeps_;
  const std::vector<std::optional<TrackSpline>>& splines_;
  KeyedMotion motion_;
  FigureStepper stepper_;
  std::vector<Memory> memories_;
  std::vector<double> inputs_, last_acceleration_;
  FigureState start_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
