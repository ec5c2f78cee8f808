#include <algorithm>
#include <cmath>

#include "controller_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kSlop = 1e-3;  // m, that may be left in penetration

}  // namespace

// Hands over what has to be dynamic now; bodies that are pushed back meet fixed ones too, but leave the
// answer to us.
void ArticulatedController::Impl::choose() {
  std::vector<char>& next = now;
  const double time = figure.time();
  bool same = true;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    bool dynamic = wanted[i] != 0;
    if (settings.live) {
      for (const DynamicInterval& d : animation.clip().dynamics) {
        if (time < d.begin - 1e-9 || time > d.end - 1e-9) continue;
        dynamic = dynamic || std::find(d.links.begin(), d.links.end(), static_cast<int>(i)) != d.links.end();
      }
      for (const PlaceInterval& p : animation.clip().places) {
        const bool holds = time > p.begin - 1e-9 && time < p.end - 1e-9;
        dynamic = dynamic || (i == 0 && holds && p.rule == PlaceRule::kContact);
      }
    }
    if (animation.model().links()[i].joint == JointKind::kFixed) dynamic = false;
    same = same && dynamic == figure.dynamic(static_cast<int>(i));
    next[i] = dynamic;
  }
  if (same) return;
  figure.choose(next, settings.return_time);
  ++counts.handovers;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    btRigidBody& body = *bodies[i].body;
    const bool carried = figure.carried(bodies[i].capsule.link);
    if (carried == (links[i] >= 0)) continue;
    links[i] = carried ? bodies[i].capsule.link : -1;
    constexpr int kSilent = btCollisionObject::CF_NO_CONTACT_RESPONSE;
    const int flags = body.getCollisionFlags();
    body.setCollisionFlags(carried ? flags | kSilent : flags & ~kSilent);
    world.removeRigidBody(&body);
    constexpr int kFixed = btBroadphaseProxy::StaticFilter | btBroadphaseProxy::KinematicFilter;
    world.addRigidBody(&body, group, carried ? mask | kFixed : mask);
  }
}

// What the contacts give for the rates `speed`, which take it on; both sides of it.
void ArticulatedController::Impl::strike(double when, const FigureState& at, std::vector<double>& speed) {
  answer = speed;
  impulses.solve(figure.prepare(at, when), at.q.data(), 0, touches.contacts(), answer.data(),
                 touches.others());
  const auto finite = [](const auto& v) { return v.allFinite(); };
  const bool sound = std::all_of(impulses.impulses().begin(), impulses.impulses().end(), finite) &&
                     std::all_of(answer.begin(), answer.end(), [](double x) { return std::isfinite(x); });
  if (!sound) {  // left out, on both sides
    ++counts.guard_fired;
    return;
  }
  speed = answer;
  touches.push_back(impulses.impulses());
  for (std::size_t i = 0; i < touches.contacts().size(); ++i) {
    const Vec3& p = impulses.impulses()[i];
    pressed = pressed || p.squaredNorm() > 0;
    counts.impulse += p;
    counts.impulse_moment += touches.contacts()[i].point.cross(p);
  }
}

// Half of what the contacts give before the part, half after it, as in (27) of doc/dynamics.md.
void ArticulatedController::Impl::advance_part(double dt) {
  const bool floats = now[0] && animation.model().links()[0].joint == JointKind::kFree;
  const Vec3& gravity = animation.settings().gravity;
  const double start = figure.time();
  figure.step(dt);
  if (!touches.empty()) {
    const FigureState& from = figure.before();
    for (std::size_t k = 0; k < rates.size(); ++k) mean[k] = 0.5 * (from.qd[k] + figure.state().qd[k]);
    rates = mean;
    for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
      touches.contacts()[i].lowest = -std::max(touches.gaps()[i], 0.0) / dt;
    }
    pressed = false;
    strike(start, from, rates);
    if (pressed) {
      for (std::size_t k = 0; k < rates.size(); ++k) rates[k] = from.qd[k] + (rates[k] - mean[k]);
      figure.step_again(rates, dt);
    }
  }
  if (floats) {
    rates = figure.state().qd;
    momentum.keep(gravity, dt, figure.before(), figure.state(), rates);
    figure.set_rates(rates);
  }
  if (touches.empty() || !pressed) return;
  rates = figure.state().qd;
  for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
    const bool near = impulses.impulses()[i].squaredNorm() > 0;
    touches.contacts()[i].lowest = near ? 0 : -std::max(touches.gaps()[i], 1e-3) / dt;
  }
  strike(figure.time(), figure.state(), rates);
  figure.set_rates(rates);
}

// A fifth of what is deeper than the slop, of the figure alone.
void ArticulatedController::Impl::push_out() {
  bool deep = false;
  for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
    const double depth = -touches.gaps()[i] - kSlop;
    touches.contacts()[i].lowest = depth > 0 ? std::min(0.2 * depth, 0.02) : -1;
    touches.contacts()[i].other = -1;
    deep = deep || depth > 0;
  }
  if (!deep) return;
  impulses.push_out(figure.prepare(figure.state(), figure.time()), figure.state().q.data(),
                    touches.contacts(), by.data());
  const bool floats = now[0] && animation.model().links()[0].joint == JointKind::kFree;
  if (floats) before = figure.state();
  figure.move(by);
  if (!floats) return;
  rates = figure.state().qd;
  momentum.keep(animation.settings().gravity, 0, before, figure.state(), rates);
  figure.set_rates(rates);
}

void ArticulatedController::Impl::advance(double dt) {
  choose();
  if (!figure.any_dynamic()) {
    figure.step(dt);
    return;
  }
  const long long guarded = figure.guard_fired();
  touches.gather(world, shown, links);
  counts.contacts += static_cast<long long>(touches.contacts().size());
  const int parts = std::max(1, static_cast<int>(std::ceil(dt / settings.max_step - 1e-9)));
  for (int k = 0; k < parts; ++k) advance_part(dt / parts);
  if (!touches.empty()) push_out();
  counts.guard_fired += figure.guard_fired() - guarded;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
