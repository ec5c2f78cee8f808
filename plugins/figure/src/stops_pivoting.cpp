// Who leans on a stop and what blows give: the one solution of a complementarity problem, found by pivoting,
// each pivot one O(N) pass with the joints that lean prescribed. Equations (14) and (15) of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "stops_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr int kManyBlows = 8;
constexpr double kNextTo = 1e-9;  // rad or m, and that a second: to begin with
constexpr double kFarthestNextTo = 1e-6;

// Pivoting: `violation(i, held)` > 0 says that joint i is on the wrong side: held by a pull, or free and
// going through. Whole blocks change sides while that helps, then one at a time by the least index, which
// always ends.
template <class Pass, class Violation>
void pivot(std::vector<Stop>& stops, const std::vector<Stop>& touching, LimitCounts& counts, Pass pass,
           Violation violation) {
  int best = static_cast<int>(stops.size()) + 1, patience = 5;
  const int most = 20 + 8 * static_cast<int>(stops.size());
  for (int round = 0; round < most; ++round) {
    pass();
    ++counts.passes;
    int wrong = 0;
    for (std::size_t i = 0; i < stops.size(); ++i) wrong += touching[i] != Stop::kFree && violation(i);
    if (wrong == 0) return;
    if (wrong < best) {
      best = wrong;
      patience = 5;
    } else {
      --patience;
    }
    for (std::size_t i = 0; i < stops.size(); ++i) {
      if (touching[i] == Stop::kFree || !violation(i)) continue;
      stops[i] = stops[i] == Stop::kFree ? touching[i] : Stop::kFree;
      if (patience < 0) break;
    }
  }
  ++counts.unfinished;
}

}  // namespace

// (14): the impulses that keep joints which touch their stops from going through them.
void FigureStepper::Impl::meet_stops(double at) {
  // Two joints that throw each other back and forth against their stops meet them ever faster, without end:
  // after some blows in one step, who is next to its stop is there.
  const double near =
      blows < kManyBlows ? 0.0 : std::min(kNextTo * std::exp2((blows - kManyBlows) / 8.0), kFarthestNextTo);
  bool any = false;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const Limited& joint = limited[i];
    const double inside = std::min(near, 0.5 * (joint.upper - joint.lower));
    candidates[i] = chosen[static_cast<std::size_t>(joint.link)]
                        ? touched(place_of(joint, state), joint.lower + inside, joint.upper - inside)
                        : Stop::kFree;
    any = any || sign_of(candidates[i]) * rate_of(joint, state) > 0;
  }
  if (!any) return;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const bool hits = sign_of(candidates[i]) * rate_of(limited[i], state) > 0;
    if (hits) {
      note(at, static_cast<int>(i), true);
      stops[i] = candidates[i];
    }
  }
  std::fill(held.begin(), held.end(), 0);  // no friction holds against a blow
  const Vec3 gravity = dynamics.gravity(), base = dynamics.base_acceleration();
  dynamics.set_gravity(Vec3::Zero());
  dynamics.set_base_acceleration(Vec3::Zero());
  look_at_balls(state);
  double scale = 0, fastest = 0;
  pivot(
      stops, candidates, counts,
      [&] {
        set_joints();
        std::fill(acceleration.begin(), acceleration.end(), 0.0);
        for (std::size_t i = 0; i < limited.size(); ++i) {
          const auto v = static_cast<std::size_t>(limited[i].v);
          if (stops[i] != Stop::kFree && limited[i].part == Limited::Part::kNumber)
            acceleration[v] = -state.qd[v];
        }
        dynamics.forward(state.q.data(), still.data(), nullptr, acceleration.data());
        keep_rows(state, acceleration.data(), Keep::kRates);
        dynamics.inverse(state.q.data(), still.data(), acceleration.data(), torque.data(), pin_loads);
        scale = fastest = 0;
        for (const double t : torque) scale = std::max(scale, std::abs(t));
        for (const double v : state.qd) fastest = std::max(fastest, std::abs(v));
        for (const double a : acceleration) fastest = std::max(fastest, std::abs(a));
      },
      [&](std::size_t i) {
        const double side = sign_of(candidates[i]);
        if (stops[i] != Stop::kFree) return side * pull_of(i) > kRounding * scale;
        const double gain = gain_of(i, false);
        const bool number = limited[i].part == Limited::Part::kNumber;
        return side * (rate_of(limited[i], state) + gain) > kRounding * (number ? std::abs(gain) : fastest);
      });
  dynamics.set_gravity(gravity);
  dynamics.set_base_acceleration(base);
  for (std::size_t k = 0; k < state.qd.size(); ++k) state.qd[k] += acceleration[k];
  for (std::size_t k = 0; k < pin_loads.size(); ++k) pin_impulses[k] += pin_loads[k].force;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const double rate = rate_of(limited[i], state);
    if (stops[i] != Stop::kFree || sign_of(candidates[i]) * rate > 0) calm(limited[i], state);
    if (near > 0 && candidates[i] != Stop::kFree &&
        std::abs(rate) <= near) {  // the last of ever smaller bounces
      calm(limited[i], state);
      stops[i] = candidates[i];
    }
    if (stops[i] != Stop::kFree && near > 0) {
      put(limited[i], stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper, state);
    }
  }
}

// (15): of the joints at rest on a stop, those stay that would accelerate through it.
void FigureStepper::Impl::lean_on_stops(double at) {
  bool any = false;
  std::vector<Stop>& before = leaning;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const Limited& joint = limited[i];
    const bool rests = chosen[static_cast<std::size_t>(joint.link)] && rate_of(joint, state) == 0;
    candidates[i] = rests ? touched(place_of(joint, state), joint.lower, joint.upper) : Stop::kFree;
    before[i] = stops[i];
    stops[i] = candidates[i];
    any = any || candidates[i] != before[i] || candidates[i] != Stop::kFree;
  }
  if (!any) return;
  look_at_balls(state);
  double scale = 0, rate_scale = 0;
  pivot(
      stops, candidates, counts,
      [&] {
        set_joints();
        torques_of_stops(state, at);
        scale = rate_scale = 0;
        for (const double t : torque) scale = std::max(scale, std::abs(t));
        for (const double a : acceleration) rate_scale = std::max(rate_scale, std::abs(a));
        for (const BallRange::Row& row : seen) rate_scale = std::max(rate_scale, std::abs(row.bias));
      },
      [&](std::size_t i) {
        const double side = sign_of(candidates[i]);
        if (stops[i] != Stop::kFree)
          return !stubborn[i] && let_go[i] < kMostReleases && side * pull_of(i) > kRounding * scale;
        return side * gain_of(i, true) > kRounding * rate_scale;
      });
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (before[i] != Stop::kFree && stops[i] == Stop::kFree) {
      candidates[i] = before[i];
      note(at, static_cast<int>(i), false);
    }
  }
  set_joints();
}

// Torques that the stops give, among those of all joints, for the accelerations of the others.
void FigureStepper::Impl::torques_of_stops(FigureState& at, double when) {
  if (!standing.empty()) prescribe(when, at, acceleration);
  answer(at, nullptr, acceleration.data());
  dynamics.inverse(at.q.data(), at.qd.data(), acceleration.data(), torque.data(), pin_loads);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
