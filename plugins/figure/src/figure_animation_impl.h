#pragma once

#include <map>

#include "foot_solver.h"
#include "gravity_rule.h"
#include "landing_rule.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

struct __attribute__((visibility("hidden"))) FigureAnimation::Impl {
  Impl(const FigureModel& of, FigureClip what, AnimationSettings how);

  void evaluate();
  void make_ticks();
  // A track's spline from one time on: to the next interval that takes the joint over, or to the end. `start`
  // (may be null) is the state there and stands for a key.
  void make_spline(const JointTrack& track, double from, const FigureState* start,
                   const std::vector<double>& acceleration);
  void choose_dynamic(double time);
  void choose_base(double time, const FigureState& at);
  void make_state(double time, FigureState& to);
  bool ends_soon(const DynamicPiece& piece, double time) const;

  FigureModel model;
  FigureClip clip;
  AnimationSettings settings;
  AnimationCounts counts;

  std::vector<double> ticks;                        // s: frames, and where something begins or ends
  std::vector<std::size_t> frame_ticks;             // of each frame
  std::vector<FigureState> states;                  // at the ticks
  std::vector<std::optional<TrackSpline>> splines;  // per link, in force
  std::vector<JointTrack> tracks;                   // per link
  std::vector<char> is_dynamic;                     // per link, now
  std::map<std::vector<int>, std::unique_ptr<DynamicPiece>> pieces;  // that were ever needed
  std::vector<DynamicPiece*> active;
  std::map<int, LinkChain> chains;
  BaseRule base;
  std::unique_ptr<GravityRule> gravity;  // made anew with the clip
  std::unique_ptr<LandingRule> landing;
  bool by_gravity = false, by_contact = false;
  std::vector<std::pair<FootSolver, Vec3>> feet;  // and where they stand
  std::vector<PlaceEvent> events;
  int place = -1;  // interval in force
  std::vector<double> scratch;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
