#include <algorithm>
#include <cmath>

#include "controller_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kNear = 1e-3;        // m: contacts are looked after there
constexpr double kTouching = 1e-5;    // m: nearer is contact
constexpr double kDeepest = 2e-5;     // m: deeper is pushed out,
constexpr double kMostPushed = 0.05;  // m, by no more in one of so many rounds
constexpr int kMostRounds = 12;

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

void ArticulatedController::Impl::place_capsules(double ahead) {
  const FigureState& state = figure.state();
  placer.place(state.q.data(), state.qd.data());
  const double falls = ahead * animation.settings().gravity.norm();
  std::vector<WorldTouches::Capsule>& placed = touches.capsules();
  placed.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const LinkCapsule& c = bodies[i].capsule;
    const LinkMotion m = placer.motion(c.link);
    WorldTouches::Capsule& to = placed[i];
    to.body = bodies[i].body.get();
    to.link = links[i];
    to.radius = c.radius;
    to.from = m.position + m.orientation * c.from;
    to.to = m.position + m.orientation * c.to;
    const double arm = std::max(c.from.norm(), c.to.norm()) + c.radius;
    to.reach = kNear + 1.5 * ahead * (m.velocity.norm() + m.angular_velocity.norm() * arm + falls);
  }
}

void ArticulatedController::Impl::look(double left, double ahead) {
  place_capsules(ahead);
  touches.look(left, ahead);
}

// Half of what the contacts give before the part, half after it, as in (27) of doc/dynamics.md.
void ArticulatedController::Impl::advance_part(double dt, double left) {
  const bool floats = now[0] && animation.model().links()[0].joint == JointKind::kFree;
  const Vec3& gravity = animation.settings().gravity;
  const double start = figure.time();
  if (touches.any_near()) look(left, dt);
  pressed = false;
  figure.step(dt);
  if (touches.any_near() && !touches.empty()) {
    const FigureState& from = figure.before();
    for (std::size_t k = 0; k < rates.size(); ++k) mean[k] = 0.5 * (from.qd[k] + figure.state().qd[k]);
    rates = mean;
    for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
      touches.contacts()[i].lowest = -std::max(touches.gaps()[i], 0.0) / dt;
    }
    counts.contacts += static_cast<long long>(touches.contacts().size());
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
  if (!touches.any_near()) return;
  push_out(left - dt);
  look(left - dt, 0);
  bool any = false;
  for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
    const bool near = touches.gaps()[i] <= kTouching;
    touches.contacts()[i].lowest = near ? 0 : -std::max(touches.gaps()[i], kTouching) / dt;
    any = any || near;
  }
  if (!any) return;
  rates = figure.state().qd;
  strike(figure.time(), figure.state(), rates);
  figure.set_rates(rates);
}

// What is deeper than may be is moved out, of the figure alone, with its momentum kept.
void ArticulatedController::Impl::push_out(double left) {
  const bool floats = now[0] && animation.model().links()[0].joint == JointKind::kFree;
  for (int round = 0; round < kMostRounds; ++round) {
    look(left, 0);
    bool deep = false;
    for (std::size_t i = 0; i < touches.gaps().size(); ++i) {
      touches.contacts()[i].lowest = -touches.gaps()[i];
      touches.contacts()[i].other = -1;
      touches.contacts()[i].lowest = std::min(touches.contacts()[i].lowest, kMostPushed);
      deep = deep || touches.gaps()[i] < -kDeepest;
    }
    if (!deep) return;
    before = figure.state();
    if (round < kMostRounds / 2 || !floats) {
      impulses.push_out(figure.prepare(figure.state(), figure.time()), figure.state().q.data(),
                        touches.contacts(), by.data());
    } else {  // joints at their stops do not give way: all of it, then
      Vec3 shift = Vec3::Zero();
      for (const ContactImpulses::Contact& c : touches.contacts())
        shift += std::max(0.0, c.lowest - shift.dot(c.normal)) * c.normal;
      std::fill(by.begin(), by.end(), 0.0);
      for (std::size_t k = 0; k < 3; ++k) by[k + 3] = shift[static_cast<int>(k)];
    }
    figure.move(by);
    if (!floats) continue;
    rates = figure.state().qd;
    momentum.keep(animation.settings().gravity, 0, before, figure.state(), rates);
    figure.set_rates(rates);
  }
}

void ArticulatedController::Impl::advance(double dt) {
  choose();
  if (!figure.any_dynamic()) {
    figure.step(dt);
    return;
  }
  const long long guarded = figure.guard_fired(), calls = figure.forward_calls();
  place_capsules(dt);
  touches.gather(world, shown, dt);
  const int parts = std::max(1, static_cast<int>(std::ceil(dt / settings.max_step - 1e-9)));
  for (int k = 0; k < parts; ++k) advance_part(dt / parts, dt * (parts - k) / parts);
  counts.guard_fired += figure.guard_fired() - guarded;
  counts.forward_calls += figure.forward_calls() - calls;
  counts.boxes_overlapping = touches.boxes_overlapping();
  counts.narrow_tests = touches.narrow_tests();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
