#pragma once

#include <optional>

#include "dynamic_piece.h"
#include "softpoint/figure/figure_collision.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Section 3.2 of the paper, steps (1) to (6), faults included: one joint is held while the figure touches
// something and would still do so one step on under gravity alone; else it flies by its centre of mass, and
// lands where its new pose, shifted along the way of that centre, just touches.
class GravityRule {
 public:
  GravityRule(const FigureModel& model, const FigureClip& clip, const AnimationSettings& settings);

  void begin(const PlaceInterval& rule, double time, const FigureState& state);
  // What the base is thought to do in the next frame, for joints that are dynamic.
  BaseRule guess(double time, const FigureState& from) const;
  // Places `next`, whose joints and turn are known, `dt` s after `from`.
  void place(double time, double dt, const FigureState& from, FigureState& next,
             std::vector<PlaceEvent>& events);
  const FigureCollision::Counts& counts() const { return collision_.counts(); }
  bool touching() const { return touching_; }

 private:
  Vec3 center(const FigureState& state, Vec3* velocity = nullptr);
  double gap(const Vec3& shift, Touch* deepest = nullptr);
  void hold(const FigureState& state);
  void set_rates(const Vec3& velocity, FigureState& state);

  const FigureModel& model_;
  Vec3 gravity_;
  FigureDynamics placer_;
  FigureCollision collision_;
  PlaceInterval rule_;
  bool touching_ = false;
  int held_ = 0;
  std::optional<LinkChain> chain_;
  Vec3 place_ = Vec3::Zero();  // m, of the joint that is held
  Vec3 way_ = Vec3::Zero();    // m/s, mean velocity of the centre of mass in the last frame
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
