#include "landing_rule.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "ball_range.h"
#include "group_motion.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kTouching = 1e-5;          // m: nearer is contact
constexpr double kDeepest = 2e-5;           // m: deeper is pushed out
constexpr double kContactStep = 1.0 / 240;  // s
constexpr double kNear = 1e-3;              // m: contacts are looked after there
constexpr double kFarthest = 10;            // m, that gaps are looked for

}  // namespace

LandingRule::LandingRule(const FigureModel& model, const FigureClip& clip, const AnimationSettings& settings,
                         const std::vector<std::optional<TrackSpline>>& splines)
    : model_(model),
      settings_(settings),
      placer_(model),
      collision_(model, clip.capsules, clip.obstacles),
      impulses_(model),
      momentum_(model),
      motion_(model, splines),
      speed_(static_cast<std::size_t>(model.velocity_count())),
      shift_(speed_.size()),
      acceleration_(speed_.size()) {
  placer_.set_gravity(settings.gravity);
}

void LandingRule::choose(const std::vector<char>& dynamic) {
  if (stepper_ && dynamic == dynamic_) return;
  dynamic_ = dynamic;
  std::vector<int> links = {0};
  motion_.links.clear();
  const auto flags = std::make_unique<bool[]>(dynamic.size());
  for (std::size_t i = 0; i < dynamic.size(); ++i) {
    flags[i] = i == 0 || dynamic[i] != 0;
    if (dynamic[i]) links.push_back(static_cast<int>(i));
    if (!flags[i]) motion_.links.push_back(static_cast<int>(i));
  }
  free_model_.emplace(with_friction_of(with_ranges_of(model_, links), links, settings_));
  stepper_.emplace(*free_model_, state_inside(*free_model_), settings_.integrator);
  stepper_->dynamics().set_gravity(settings_.gravity);
  stepper_->set_dynamic({flags.get(), dynamic.size()});
  for (const auto& [link, factor] : settings_.paper_friction) stepper_->set_paper_friction(link, factor);
  stepper_->set_limits(settings_.limits);
  stepper_->set_prescribed_motion(&motion_);
}

// What a rounding or a push has moved out of the ranges of the dynamic joints.
void LandingRule::keep_inside(FigureState& state) const {
  for (int i = 0; i < free_model_->link_count(); ++i) {
    put_inside(free_model_->links()[static_cast<std::size_t>(i)],
               state.q.data() + free_model_->position_offset(i));
  }
}

bool LandingRule::fly(double time, double dt, const FigureState& from, FigureState& to) {
  scratch_ = from;
  keep_inside(scratch_);
  stepper_->set_state(scratch_);
  stepper_->set_time(time);
  const int parts =
      std::max(1, static_cast<int>(std::ceil(dt / settings_.frame_time * settings_.substeps - 1e-9)));
  bool finite = true;
  for (int k = 0; k < parts && finite; ++k) finite = stepper_->step(dt / parts);
  to = stepper_->state();
  if (finite) momentum_.keep(settings_.gravity, dt, from, to, to.qd);
  totals_->guard_fired += !finite;
  return finite;
}

double LandingRule::gap(const FigureState& state, double reach) {
  placer_.place(state.q.data(), state.qd.data());
  collision_.place(placer_);
  double least = reach;
  for (const Touch& touch : collision_.near(reach)) {
    if (touch.obstacle >= 0) least = std::min(least, touch.gap);
  }
  return least;
}

// Of all points of the capsules, as they were placed last.
double LandingRule::fastest() {
  double most = 0;
  for (const LinkCapsule& c : collision_.capsules()) {
    const LinkMotion m = placer_.motion(c.link);
    const double arm = std::max(c.from.norm(), c.to.norm()) + c.radius;
    most = std::max(most, m.velocity.norm() + m.angular_velocity.norm() * arm);
  }
  return most;
}

// (25): flight until something touches: no step is longer than the gap at the speed that anything could
// reach.
double LandingRule::to_contact(double time, double dt, const FigureState& from, FigureState& to) {
  double t = 0;
  to = from;
  for (int look = 0; look < 200; ++look) {
    const double least = gap(to, kFarthest);
    if (least <= kTouching && t > 0) return t;
    const double left = dt - t;
    const double speed = 1.2 * fastest() + 4 * settings_.gravity.norm() * left + 0.1;
    const double safe = std::max(least, 0.5 * kTouching) / speed;
    t = safe >= left ? dt : t + safe;
    if (!fly(time, t, from, to)) return t;
    if (t >= dt) return dt;
  }
  return t;
}

// Contacts at which `reach` is left at most; the gap may be used up within `dt` (0: at once).
void LandingRule::gather(const FigureState& state, double reach, double dt) {
  placer_.place(state.q.data(), state.qd.data());
  collision_.place(placer_);
  contacts_.clear();
  for (const Touch& touch : collision_.near(std::min(reach, kFarthest))) {
    if (touch.obstacle < 0) continue;
    const int link = collision_.capsules()[static_cast<std::size_t>(touch.capsule)].link;
    contacts_.push_back({link, touch.point, touch.normal, dt > 0 ? -std::max(touch.gap, 0.0) / dt : 0});
  }
}

// Articulated inertias where the figure is, for the impulses.
void LandingRule::prepare(double time, const FigureState& state) {
  scratch_ = state;
  motion_.evaluate(time, scratch_.q.data(), scratch_.qd.data(), acceleration_.data());
  stepper_->dynamics().forward(state.q.data(), state.qd.data(), nullptr, acceleration_.data());
}

// (26): what the contacts have to give for the rates `speed`, given to the state's.
void LandingRule::strike(double time, FigureState& state, const std::vector<double>& speed) {
  if (contacts_.empty()) return;
  prepare(time, state);
  shift_ = speed;
  impulses_.solve(stepper_->dynamics(), state.q.data(), settings_.friction, contacts_, shift_.data());
  for (std::size_t k = 0; k < shift_.size(); ++k) state.qd[k] += shift_[k] - speed[k];
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Vec3& p = impulses_.impulses()[i];
    totals_->impulse += p;
    totals_->impulse_moment += contacts_[i].point.cross(p);
    if (p.squaredNorm() > 0) {
      pressed_ = true;
      last_link_ = contacts_[i].link;
    }
  }
}

// (27): half of what the contacts give before the flight, half after it.
void LandingRule::in_contact(double time, double dt, FigureState& state) {
  if (!fly(time, dt, state, trial_)) return;
  gap(state, 1e-9);
  gather(state, kNear + 1.5 * dt * fastest(), dt);
  for (std::size_t k = 0; k < speed_.size(); ++k) speed_[k] = 0.5 * (state.qd[k] + trial_.qd[k]);
  const std::vector<double> mean = speed_;
  const bool was = pressed_;
  pressed_ = false;
  strike(time, state, mean);
  if (pressed_) {
    if (!fly(time, dt, state, trial_)) return;
  }
  pressed_ = pressed_ || was;
  state = trial_;
  push_out(time + dt, state);
  gather(state, kTouching, 0);
  strike(time + dt, state, std::vector<double>(state.qd));
}

void LandingRule::push_out(double time, FigureState& state) {
  for (int round = 0; round < 20; ++round) {
    if (gap(state, kTouching) > -kDeepest) return;
    contacts_.clear();
    for (const Touch& touch : collision_.near(kTouching)) {
      if (touch.obstacle < 0) continue;
      const int link = collision_.capsules()[static_cast<std::size_t>(touch.capsule)].link;
      contacts_.push_back({link, touch.point, touch.normal, std::min(-touch.gap, 0.05)});
    }
    const FigureState before = state;
    if (round < 5) {
      prepare(time, state);
      impulses_.push_out(stepper_->dynamics(), state.q.data(), contacts_, shift_.data());
      move_by(model_, state.q.data(), shift_.data(), state.q.data());
      keep_inside(state);
    } else {  // joints at their stops do not give way: all of it, then
      Vec3 by = Vec3::Zero();
      for (const ContactImpulses::Contact& c : contacts_)
        by += std::max(0.0, c.lowest - by.dot(c.normal)) * c.normal;
      for (std::size_t k = 0; k < 3; ++k) {
        state.q[static_cast<std::size_t>(model_.position_offset(0)) + k] += by[static_cast<int>(k)];
      }
    }
    momentum_.keep(settings_.gravity, 0, before, state, state.qd);
  }
}

void LandingRule::advance_held(double time, double dt, const FigureState& from, FigureState& next) {
  scratch_ = from;
  keep_inside(scratch_);
  stepper_->set_pins({});
  stepper_->set_state(scratch_);
  stepper_->set_time(time);
  stepper_->set_pins(pins_);
  const int parts =
      std::max(1, static_cast<int>(std::ceil(dt / settings_.frame_time * settings_.substeps - 1e-9)));
  for (int k = 0; k < parts; ++k) {
    totals_->guard_fired += !stepper_->step(dt / parts);
    for (std::size_t i = 0; i < pins_.size(); ++i) {
      const Vec3& p = stepper_->pin_impulses()[i];
      totals_->impulse += p;
      totals_->impulse_moment += pins_[i].place.cross(p);
    }
  }
  next = stepper_->state();
  stepper_->set_pins({});
}

void LandingRule::advance(double time, double dt, const std::vector<char>& dynamic, const FigureState& from,
                          FigureState& next, std::vector<PlaceEvent>& events, AnimationCounts& counts) {
  totals_ = &counts;
  choose(dynamic);
  const long long before = stepper_->dynamics().counts().calls;
  if (!pins_.empty()) {
    advance_held(time, dt, from, next);
    ++counts.dynamic_steps;
    counts.forward_calls += stepper_->dynamics().counts().calls - before;
    touching_ = true;
    last_link_ = pins_[0].link;
    return;
  }
  FigureState state = from;
  double done = 0;
  pressed_ = false;
  while (done < dt * (1 - 1e-12)) {
    pressed_ = false;
    if (gap(state, kNear) >= kNear) {
      FigureState to;
      done += to_contact(time + done, dt - done, state, to);
      state = to;
      push_out(time + done, state);
      gather(state, 2 * kTouching, 0);
      strike(time + done, state, std::vector<double>(state.qd));
      continue;
    }
    const double left = dt - done;
    const double step = left / std::ceil(left / kContactStep - 1e-9);
    in_contact(time + done, step, state);
    done += step;
  }
  ++counts.dynamic_steps;
  counts.forward_calls += stepper_->dynamics().counts().calls - before;
  const bool now = pressed_;
  if (now != touching_) {
    events.push_back({now ? PlaceEvent::Kind::kLanding : PlaceEvent::Kind::kTakeOff, time + dt, last_link_});
  }
  touching_ = now;
  next = state;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
