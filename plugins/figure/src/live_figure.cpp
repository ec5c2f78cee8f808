#include "live_figure.h"

#include <algorithm>
#include <memory>

#include "ball_range.h"
#include "group_motion.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kDifference = 1e-4;  // s, of rates for accelerations

}  // namespace

LiveFigure::LiveFigure(const FigureAnimation& animation)
    : animation_(animation),
      model_(animation.model()),
      state_(rest_state(model_)),
      before_(state_),
      shown_(state_),
      dynamic_(static_cast<std::size_t>(model_.link_count()), 0),
      carried_(dynamic_),
      returns_(dynamic_.size()),
      until_(dynamic_.size(), 0.0),
      acceleration_(state_.qd.size()),
      sample_(state_),
      sooner_(state_),
      later_(state_) {
  restart(0);
}

void LiveFigure::restart(double time) {
  time_ = time;
  any_ = false;
  std::fill(dynamic_.begin(), dynamic_.end(), 0);
  std::fill(carried_.begin(), carried_.end(), 0);
  for (auto& spline : returns_) spline.reset();
  animation_.sample(time, state_);
}

void LiveFigure::choose(const std::vector<char>& dynamic, double return_time) {
  animation_.sample(time_ + return_time, later_);
  std::vector<Link> links = animation_.model().links();
  const auto flags = std::make_unique<bool[]>(links.size());
  any_ = false;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const int link = static_cast<int>(i);
    flags[i] = dynamic[i] != 0 && links[i].joint != JointKind::kFixed;
    any_ = any_ || flags[i];
    const int parent = links[i].parent;
    carried_[i] = flags[i] || (parent >= 0 && carried_[static_cast<std::size_t>(parent)]);
    const int q = model_.position_offset(link), v = model_.velocity_offset(link);
    if (flags[i]) {  // keys may have led it out of its range: then it may not go further
      widen_range(links[i], state_.q.data() + q);
    } else {
      open_range(links[i]);
    }
    if (flags[i]) returns_[i].reset();
    if (flags[i] || !dynamic_[i] || links[i].joint == JointKind::kFixed) continue;
    JointTrack track{link, Interpolation::kCubic, {}};
    const int positions = position_count(links[i].joint), rates = velocity_count(links[i].joint);
    const auto key = [&](double time, const FigureState& at) {
      const auto x = at.q.begin() + q, y = at.qd.begin() + v;
      track.keys.push_back({time, {x, x + positions}, {y, y + rates}});
    };
    key(time_, state_);
    key(time_ + return_time, later_);
    check_track(animation_.model(), track);
    returns_[i].emplace(animation_.model(), track);
    until_[i] = time_ + return_time;
  }
  for (std::size_t i = 0; i < links.size(); ++i) dynamic_[i] = flags[i];
  model_ = FigureModel(std::move(links));
  if (!any_) {
    stepper_.reset();
    return;
  }
  stepper_.emplace(model_, state_);
  stepper_->dynamics().set_gravity(animation_.settings().gravity);
  stepper_->set_dynamic({flags.get(), dynamic_.size()});
  stepper_->set_limits(LimitMode::kExact);
  stepper_->set_prescribed_motion(this);
}

void LiveFigure::evaluate(double time, double* q, double* qd, double* qdd) const {
  animation_.sample(time, sample_);
  animation_.sample(time - kDifference, sooner_);
  animation_.sample(time + kDifference, later_);
  for (std::size_t i = 0; i < dynamic_.size(); ++i) {
    if (dynamic_[i]) continue;
    const int link = static_cast<int>(i);
    const auto at = static_cast<std::size_t>(model_.position_offset(link));
    const auto v = static_cast<std::size_t>(model_.velocity_offset(link));
    if (returning(i, time)) {
      returns_[i]->evaluate(time, q + at, qd + v, qdd + v);
      continue;
    }
    const JointKind kind = model_.links()[i].joint;
    std::copy_n(sample_.q.data() + at, position_count(kind), q + at);
    std::copy_n(sample_.qd.data() + v, velocity_count(kind), qd + v);
    for (std::size_t k = v; k < v + static_cast<std::size_t>(velocity_count(kind)); ++k) {
      qdd[k] = (later_.qd[k] - sooner_.qd[k]) / (2 * kDifference);
    }
  }
}

void LiveFigure::keep_inside() {
  for (int i = 0; i < model_.link_count(); ++i) {
    const Link& link = model_.links()[static_cast<std::size_t>(i)];
    if (!dynamic_[static_cast<std::size_t>(i)]) continue;
    put_inside(link, state_.q.data() + model_.position_offset(i));
  }
}

void LiveFigure::advance(double dt) {
  if (!any_) {
    time_ = begin_ + dt;
    evaluate(time_, state_.q.data(), state_.qd.data(), acceleration_.data());
    return;
  }
  if (changed_) {
    keep_inside();
    stepper_->set_state(state_);
  }
  changed_ = false;
  stepper_->set_time(begin_);
  guard_fired_ += !stepper_->step(dt);
  state_ = stepper_->state();
  time_ = begin_ + dt;
}

void LiveFigure::step(double dt) {
  before_ = state_;
  begin_ = time_;
  advance(dt);
}

void LiveFigure::step_again(const std::vector<double>& rates, double dt) {
  state_ = before_;
  state_.qd = rates;
  before_.qd = rates;
  changed_ = true;
  advance(dt);
}

void LiveFigure::move(const std::vector<double>& by) {
  move_by(model_, state_.q.data(), by.data(), state_.q.data());
  changed_ = true;
  keep_inside();
}

FigureDynamics& LiveFigure::prepare(const FigureState& at, double when) {
  shown_ = at;
  evaluate(when, shown_.q.data(), shown_.qd.data(), acceleration_.data());
  stepper_->dynamics().forward(at.q.data(), at.qd.data(), nullptr, acceleration_.data());
  return stepper_->dynamics();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
