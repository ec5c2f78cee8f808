#include "gravity_rule.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kTouchGap =
    1e-3;                        // m: nearer is touching, or a pinned foot would leave the floor by rounding
constexpr double kReach = 0.05;  // m, of the search

}  // namespace

GravityRule::GravityRule(const FigureModel& model, const FigureClip& clip, const AnimationSettings& settings)
    : model_(model),
      gravity_(settings.gravity),
      placer_(model),
      collision_(model, clip.capsules, clip.obstacles) {}

// Centre of mass, of the state that is then placed; the capsules with it.
Vec3 GravityRule::center(const FigureState& state, Vec3* velocity) {
  placer_.place(state.q.data(), state.qd.data());
  collision_.place(placer_);
  const FigureMechanics sums = placer_.mechanics();
  if (velocity != nullptr) *velocity = sums.momentum / model_.total_mass();
  return sums.center_of_mass;
}

// Smallest gap of the placed capsules shifted; kReach where there is none.
double GravityRule::gap(const Vec3& shift, Touch* deepest) {
  collision_.shift(shift);
  double least = kReach;
  for (const Touch& touch : collision_.near(kReach)) {
    if (touch.gap >= least) continue;
    least = touch.gap;
    if (deepest != nullptr) *deepest = touch;
  }
  collision_.shift(-shift);
  return least;
}

void GravityRule::hold(const FigureState& state) {
  chain_.emplace(model_, held_);
  place_ = chain_->evaluate(rule_.point, state.q.data(), nullptr, nullptr).position;
}

void GravityRule::begin(const PlaceInterval& rule, double, const FigureState& state) {
  // Intervals that follow each other are one flight: what was held and how it flew stays.
  const bool goes_on = chain_.has_value() && rule_.link == rule.link && rule_.end == rule.begin;
  rule_ = rule;
  if (goes_on) return;
  held_ = std::max(rule.link, 0);
  center(state);
  Touch touch;
  touching_ = gap(Vec3::Zero(), &touch) <= kTouchGap;
  if (touching_ && rule.link < 0) held_ = collision_.capsules()[static_cast<std::size_t>(touch.capsule)].link;
  hold(state);
  FigureState moving = state;
  if (touching_) {
    BaseRule base{&*chain_, rule_.point, place_};
    base.apply(model_, moving.q.data(), moving.qd.data(), nullptr);
  }
  center(moving, &way_);
}

BaseRule GravityRule::guess(double time, const FigureState& from) const {
  BaseRule base;
  if (touching_) {
    base.pinned = &*chain_;
    base.point = rule_.point;
    base.place = place_;
    return base;
  }
  base.flies = true;
  base.time = time;
  const auto at = from.q.begin() + model_.position_offset(0);
  const auto rate = from.qd.begin() + model_.velocity_offset(0) + 3;
  base.place = {at[0], at[1], at[2]};
  base.rate = {rate[0], rate[1], rate[2]};
  base.gain = gravity_;
  return base;
}

// The base's velocity at which the centre of mass has the one given.
void GravityRule::set_rates(const Vec3& velocity, FigureState& state) {
  const auto v = static_cast<std::size_t>(model_.velocity_offset(0) + 3);
  for (std::size_t k = 0; k < 3; ++k) state.qd[v + k] = 0;
  Vec3 own;
  center(state, &own);
  for (std::size_t k = 0; k < 3; ++k)
    state.qd[v + k] = velocity[static_cast<int>(k)] - own[static_cast<int>(k)];
}

void GravityRule::place(double time, double dt, const FigureState& from, FigureState& next,
                        std::vector<PlaceEvent>& events) {
  const auto root = static_cast<std::size_t>(model_.position_offset(0));
  const auto move = [&](const Vec3& by) {
    for (std::size_t k = 0; k < 3; ++k) next.q[root + k] += by[static_cast<int>(k)];
  };
  const Vec3 start = center(from);
  // (2): under gravity alone.
  const Vec3 fly = start + dt * way_ + dt * dt * gravity_;
  move(fly - center(next));
  center(next);
  Touch touch;
  const double ahead = gap(Vec3::Zero(), &touch);
  if (touching_ && ahead <= kTouchGap) {  // (3)
    const BaseRule base{&*chain_, rule_.point, place_};
    base.apply(model_, next.q.data(), next.qd.data(), nullptr);
    way_ = (center(next) - start) / dt;
    return;
  }
  if (touching_ || ahead > kTouchGap) {  // (4), (5)
    if (touching_) events.push_back({PlaceEvent::Kind::kTakeOff, time + dt, held_});
    touching_ = false;
    way_ = (fly - start) / dt;
    set_rates(way_ + 0.5 * dt * gravity_, next);
    return;
  }
  // (6): back along the way of the centre of mass.
  const Vec3 back = start - fly;
  double free = 1, through = 0;  // shares of `back`
  if (gap(back, &touch) > 0) {
    for (int k = 0; k < 60; ++k) {
      const double middle = 0.5 * (free + through);
      (gap(middle * back, &touch) > 0 ? free : through) = middle;
    }
  }
  gap(free * back, &touch);
  move(free * back);
  if (rule_.link < 0) held_ = collision_.capsules()[static_cast<std::size_t>(touch.capsule)].link;
  touching_ = true;
  hold(next);
  events.push_back({PlaceEvent::Kind::kLanding, time + dt, held_});
  way_ = (center(next) - start) / dt;
  const BaseRule base{&*chain_, rule_.point, place_};
  base.apply(model_, next.q.data(), next.qd.data(), nullptr);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
