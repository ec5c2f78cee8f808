#pragma once

#include "contact_impulses.h"
#include "dynamic_piece.h"
#include "momentum_keeper.h"
#include "softpoint/figure/figure_collision.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// The base as a free joint among the dynamic ones: flight with its momentum, contact in time, inelastic
// landing, friction, release where a contact would have to pull. Equations (24) to (27) of doc/dynamics.md.
class LandingRule {
 public:
  LandingRule(const FigureModel& model, const FigureClip& clip, const AnimationSettings& settings,
              const std::vector<std::optional<TrackSpline>>& splines);

  // Makes `next` from `from`; `dynamic` are the links left to dynamics besides the base.
  void advance(double time, double dt, const std::vector<char>& dynamic, const FigureState& from,
               FigureState& next, std::vector<PlaceEvent>& events, AnimationCounts& counts);
  // From the next frame on these points are held and nothing is touched; none: contact again.
  void hold(std::vector<PinnedPoint> pins) { pins_ = std::move(pins); }
  bool touching() const { return touching_; }
  const FigureCollision::Counts& counts() const { return collision_.counts(); }

 private:
  void advance_held(double time, double dt, const FigureState& from, FigureState& next);
  void choose(const std::vector<char>& dynamic);
  bool fly(double time, double dt, const FigureState& from, FigureState& to);
  void keep_inside(FigureState& state) const;
  double to_contact(double time, double dt, const FigureState& from, FigureState& to);
  double gap(const FigureState& state, double reach);
  double fastest();
  void gather(const FigureState& state, double reach, double dt);
  void strike(double time, FigureState& state, const std::vector<double>& speed);
  void in_contact(double time, double dt, FigureState& state);
  void push_out(double time, FigureState& state);
  void prepare(double time, const FigureState& state);

  const FigureModel& model_;
  const AnimationSettings& settings_;
  FigureDynamics placer_;
  FigureCollision collision_;
  ContactImpulses impulses_;
  MomentumKeeper momentum_;
  KeyedMotion motion_;
  std::vector<PinnedPoint> pins_;
  std::vector<char> dynamic_;
  std::optional<FigureModel> free_model_;  // with the ranges of the dynamic joints alone
  std::optional<FigureStepper> stepper_;
  std::vector<ContactImpulses::Contact> contacts_;
  FigureState trial_, scratch_;
  std::vector<double> speed_, shift_, acceleration_;
  bool touching_ = true, pressed_ = false;
  int last_link_ = 0;
  AnimationCounts* totals_ = nullptr;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
