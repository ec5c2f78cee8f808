#pragma once

#include <optional>
#include <vector>

#include "softpoint/figure/figure_animation.h"
#include "softpoint/figure/figure_stepper.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A figure at run time: some of its joints by dynamics, the others by an animation, and those that were
// handed back on a cubic from the state they had to the animation.
class LiveFigure final : public PrescribedMotion {
 public:
  explicit LiveFigure(const FigureAnimation& animation);
  LiveFigure(const LiveFigure&) = delete;
  LiveFigure& operator=(const LiveFigure&) = delete;

  // By the animation alone, as it is at `time`.
  void restart(double time);
  // Which joints are dynamic from now on, one flag a link; the state stays as it is. Joints handed back are
  // with the animation again after `return_time` (s).
  void choose(const std::vector<char>& dynamic, double return_time);
  bool any_dynamic() const { return any_; }
  bool dynamic(int link) const { return dynamic_[static_cast<std::size_t>(link)] != 0; }
  bool carried(int link) const {
    return carried_[static_cast<std::size_t>(link)] != 0;
  }  // by a dynamic joint

  // Goes on by `dt` (s), or as far as a guard lets it.
  void step(double dt);
  // The same from the same state once more, with other rates.
  void step_again(const std::vector<double>& rates, double dt);
  double time() const { return time_; }
  const FigureState& state() const { return state_; }
  const FigureState& before() const { return before_; }  // the last step
  void set_rates(const std::vector<double>& rates) {
    state_.qd = rates;
    changed_ = true;
  }
  // By increments of all degrees of freedom; dynamic joints stay within their ranges.
  void move(const std::vector<double>& by);
  // Articulated inertias of the present state, or of that before the last step.
  FigureDynamics& prepare(const FigureState& at, double when);
  long long guard_fired() const { return guard_fired_; }
  long long forward_calls() const { return stepper_ ? stepper_->dynamics().counts().calls : 0; }

  void evaluate(double time, double* q, double* qd, double* qdd) const override;

 private:
  void advance(double dt);
  void keep_inside();
  bool returning(std::size_t link, double time) const { return returns_[link] && time < until_[link]; }

  const FigureAnimation& animation_;
  FigureModel model_;  // with the ranges of the dynamic joints alone
  std::optional<FigureStepper> stepper_;
  FigureState state_, before_, shown_;
  std::vector<char> dynamic_, carried_;
  std::vector<std::optional<TrackSpline>> returns_;
  std::vector<double> until_;  // s
  std::vector<double> acceleration_;
  mutable FigureState sample_, sooner_, later_;
  double time_ = 0, begin_ = 0;
  bool any_ = false, changed_ = false;  // changed: the stepper does not know the state yet
  long long guard_fired_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
