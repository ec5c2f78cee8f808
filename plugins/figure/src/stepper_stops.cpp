// Ranges of joints as inelastic stops, exactly: impacts and releases are located inside the step; who leans
// on a stop is the one solution of a complementarity problem, found by pivoting, each pivot one O(N) pass
// with the joints that lean prescribed. Equations (13) to (16) of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "cubic_crossing.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr std::size_t kKeptEvents = 64;
constexpr int kManyBlows = 8;
constexpr double kNextTo = 1e-9;  // rad or m, and that a second: to begin with
constexpr double kFarthestNextTo = 1e-6;
constexpr double kNoTime = 1e-12;    // of a step
constexpr double kResting = 1e-9;    // rad/s or m/s
constexpr int kMostReleases = 16;    // of a joint in a step: then it leans to the step's end
constexpr int kMaxParts = 1000;      // of a step between events
constexpr int kMaxLocating = 40;     // re-steps for one event
constexpr double kRounding = 1e-13;  // of the largest torque, acceleration or impulse
constexpr double kGraze = 1e-14;     // rad or m: through a stop by no more is touching it

double sign_of(Stop stop) { return static_cast<double>(stop); }

// Which stop a joint touches.
Stop touched(double q, double lower, double upper) {
  return q <= lower ? Stop::kLower : q >= upper ? Stop::kUpper : Stop::kFree;
}

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

void FigureStepper::Impl::note(double at, int joint, bool impact) {
  const auto i = static_cast<std::size_t>(joint);
  ++(impact ? counts.impacts : counts.releases);
  ++blows;
  if (events.size() < kKeptEvents) {
    events.push_back({at, limited[i].link, static_cast<int>(candidates[i]), impact});
  }
}

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
    candidates[i] =
        chosen[static_cast<std::size_t>(joint.link)]
            ? touched(state.q[static_cast<std::size_t>(joint.q)], joint.lower + inside, joint.upper - inside)
            : Stop::kFree;
    any = any || sign_of(candidates[i]) * state.qd[static_cast<std::size_t>(joint.v)] > 0;
  }
  if (!any) return;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const bool hits = sign_of(candidates[i]) * state.qd[static_cast<std::size_t>(limited[i].v)] > 0;
    if (hits) {
      note(at, static_cast<int>(i), true);
      stops[i] = candidates[i];
    }
  }
  std::fill(held.begin(), held.end(), 0);  // no friction holds against a blow
  const Vec3 gravity = dynamics.gravity(), base = dynamics.base_acceleration();
  dynamics.set_gravity(Vec3::Zero());
  dynamics.set_base_acceleration(Vec3::Zero());
  double scale = 0;
  pivot(
      stops, candidates, counts,
      [&] {
        set_joints();
        std::fill(acceleration.begin(), acceleration.end(), 0.0);
        for (std::size_t i = 0; i < limited.size(); ++i) {
          const auto v = static_cast<std::size_t>(limited[i].v);
          if (stops[i] != Stop::kFree) acceleration[v] = -state.qd[v];
        }
        dynamics.forward(state.q.data(), still.data(), nullptr, acceleration.data());
        dynamics.inverse(state.q.data(), still.data(), acceleration.data(), torque.data());
        scale = 0;
        for (const double t : torque) scale = std::max(scale, std::abs(t));
      },
      [&](std::size_t i) {
        const auto v = static_cast<std::size_t>(limited[i].v);
        const double side = sign_of(candidates[i]);
        if (stops[i] != Stop::kFree) return side * torque[v] > kRounding * scale;
        return side * (state.qd[v] + acceleration[v]) > kRounding * std::abs(acceleration[v]);
      });
  dynamics.set_gravity(gravity);
  dynamics.set_base_acceleration(base);
  for (std::size_t k = 0; k < state.qd.size(); ++k) state.qd[k] += acceleration[k];
  for (std::size_t i = 0; i < limited.size(); ++i) {
    double& rate = state.qd[static_cast<std::size_t>(limited[i].v)];
    if (stops[i] != Stop::kFree || sign_of(candidates[i]) * rate > 0) rate = 0;
    if (near > 0 && candidates[i] != Stop::kFree &&
        std::abs(rate) <= near) {  // the last of ever smaller bounces
      rate = 0;
      stops[i] = candidates[i];
    }
    if (stops[i] != Stop::kFree && near > 0) {
      state.q[static_cast<std::size_t>(limited[i].q)] =
          stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper;
    }
  }
}

// (15): of the joints at rest on a stop, those stay that would accelerate through it.
void FigureStepper::Impl::lean_on_stops(double at) {
  bool any = false;
  std::vector<Stop>& before = leaning;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const Limited& joint = limited[i];
    const bool rests =
        chosen[static_cast<std::size_t>(joint.link)] && state.qd[static_cast<std::size_t>(joint.v)] == 0;
    candidates[i] =
        rests ? touched(state.q[static_cast<std::size_t>(joint.q)], joint.lower, joint.upper) : Stop::kFree;
    before[i] = stops[i];
    stops[i] = candidates[i];
    any = any || candidates[i] != before[i] || candidates[i] != Stop::kFree;
  }
  if (!any) return;
  double scale = 0, rate_scale = 0;
  pivot(
      stops, candidates, counts,
      [&] {
        set_joints();
        torques_of_stops(state, at);
        scale = rate_scale = 0;
        for (const double t : torque) scale = std::max(scale, std::abs(t));
        for (const double a : acceleration) rate_scale = std::max(rate_scale, std::abs(a));
      },
      [&](std::size_t i) {
        const auto v = static_cast<std::size_t>(limited[i].v);
        const double side = sign_of(candidates[i]);
        if (stops[i] != Stop::kFree)
          return !stubborn[i] && let_go[i] < kMostReleases && side * torque[v] > kRounding * scale;
        return side * acceleration[v] > kRounding * rate_scale;
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
  dynamics.forward(at.q.data(), at.qd.data(), nullptr, acceleration.data());
  dynamics.inverse(at.q.data(), at.qd.data(), acceleration.data(), torque.data());
}

bool FigureStepper::Impl::crosses(std::size_t i, double length, double& t, double& beyond) {
  const Limited& joint = limited[i];
  if (stops[i] != Stop::kFree || !chosen[static_cast<std::size_t>(joint.link)]) return false;
  const auto q = static_cast<std::size_t>(joint.q), v = static_cast<std::size_t>(joint.v);
  bool found = false;
  for (const double side : {-1.0, 1.0}) {
    const double bound = side < 0 ? joint.lower : joint.upper;
    double first = 0, past = 0;
    const CubicSpan span{side * (state.q[q] - bound), side * state.qd[v], side * (next.q[q] - bound),
                         side * next.qd[v], length};
    if (!first_crossing(span, first, past) || (found && first >= t)) continue;
    t = first;
    beyond = past;
    candidates[i] = side < 0 ? Stop::kLower : Stop::kUpper;
    found = true;
  }
  return found;
}

// (16): when joint i meets its stop, by Newton's method on whole re-steps kept inside a bracket; `next` is
// left there. Negative if the joint does not get there after all.
double FigureStepper::Impl::locate_impact(std::size_t i, double t, double beyond) {
  const Limited& joint = limited[i];
  const auto q = static_cast<std::size_t>(joint.q), v = static_cast<std::size_t>(joint.v);
  const double side = sign_of(candidates[i]), bound = side < 0 ? joint.lower : joint.upper;
  const double enough = 1e-15 * (1 + std::abs(bound));
  const auto gap = [&](double at) {
    advance(at);
    ++counts.resteps;
    return side * (next.q[q] - bound);
  };
  if (!(gap(beyond) > kGraze)) return -1;
  double low = 0, high = beyond;
  for (int k = 0; k < kMaxLocating; ++k) {
    const double g = gap(t);
    (g > 0 ? high : low) = t;
    if (std::abs(g) <= enough || high - low <= 1e-16 * high || k + 1 == kMaxLocating) break;
    const double rate = side * next.qd[v];
    const double better = t - g / rate;
    t = rate > 0 && better > low && better < high ? better : 0.5 * (low + high);
  }
  next.q[q] = bound;
  return t;
}

// When the first joint would have to be pulled by its stop, by the secant method inside a bracket; `next` is
// left there, and that joint is let go.
double FigureStepper::Impl::locate_release(double length) {
  bool leans = false;
  for (const Stop stop : stops) leans = leans || stop != Stop::kFree;
  if (!leans) return length;
  std::size_t worst = 0;
  double scale = 0;
  const auto pull = [&](double at) {
    torques_of_stops(next, time + at);
    double most = -1e300;
    scale = 0;
    for (const double t : torque) scale = std::max(scale, std::abs(t));
    for (std::size_t i = 0; i < stops.size(); ++i) {
      const double p = sign_of(stops[i]) * torque[static_cast<std::size_t>(limited[i].v)];
      if (stops[i] != Stop::kFree && let_go[i] < kMostReleases && p > most) {
        most = p;
        worst = i;
      }
    }
    return most;
  };
  double high = length, at_high = pull(high);
  if (!(at_high > kRounding * scale)) return length;
  double low = 0, at_low = 0, t = 0.5 * length;
  bool have_low = false;
  for (int k = 0; k < kMaxLocating; ++k) {
    advance(t);
    ++counts.resteps;
    const double p = pull(t);
    if (p > 0) {
      high = t;
      at_high = p;
      if (have_low) at_low *= 0.5;  // Illinois: the end that stays is weighed less
    } else {
      low = t;
      at_low = p;
      have_low = true;
    }
    if (std::abs(p) <= 1e-14 * scale || high - low <= 1e-15 * length || k + 1 == kMaxLocating) break;
    t = have_low ? (low * at_high - high * at_low) / (at_high - at_low) : 0.5 * high;
    if (!(t > low && t < high)) t = 0.5 * (low + high);
  }
  candidates[worst] = stops[worst];
  stops[worst] = Stop::kFree;
  ++let_go[worst];
  set_joints();
  note(time + t, static_cast<int>(worst), false);
  return t;
}

double FigureStepper::Impl::advance_to_event(double length) {
  std::fill(grazing.begin(), grazing.end(), 0);
  met = -1;
  advance(length);
  double covered = length;
  for (int look = 0; look < 8; ++look) {
    std::size_t first = limited.size();
    double t = covered, beyond = covered, tried = 0, past = 0;
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (!grazing[i] && crosses(i, covered, tried, past) && (tried < t || first == limited.size())) {
        first = i;
        t = tried;
        beyond = past;
      }
    }
    if (first == limited.size()) break;
    const double at = locate_impact(first, t, beyond);
    if (at < 0) {
      advance(covered);
      grazing[first] = 1;
      continue;
    }
    met = static_cast<int>(first);
    covered = at;  // others may have met theirs a little earlier: look again
    if (covered <= 0) break;
  }
  return locate_release(covered);
}

// What goes through a stop by no more than a rounding stands on it.
void FigureStepper::Impl::keep_inside() {
  for (const Limited& joint : limited) {
    double& q = next.q[static_cast<std::size_t>(joint.q)];
    if (chosen[static_cast<std::size_t>(joint.link)]) q = std::clamp(q, joint.lower, joint.upper);
  }
}

void FigureStepper::Impl::step_with_stops(double dt) {
  begin.q = state.q;
  begin.qd = state.qd;
  blows = 0;
  std::fill(stubborn.begin(), stubborn.end(), 0);
  std::fill(let_go.begin(), let_go.end(), 0);
  double left = dt;
  bool touching = false;
  for (const Limited& joint : limited) {
    touching = touching ||
               touched(state.q[static_cast<std::size_t>(joint.q)], joint.lower, joint.upper) != Stop::kFree;
  }
  if (touching) {
    meet_stops(time);
    lean_on_stops(time);
  }
  for (int part = 0; left > 0; ++part) {
    if (part >= kMaxParts) {  // stops the joints where they go through
      ++counts.capped;
      advance(left);
      for (const Limited& joint : limited) {
        double& q = next.q[static_cast<std::size_t>(joint.q)];
        double& v = next.qd[static_cast<std::size_t>(joint.v)];
        const Stop side = touched(q, joint.lower, joint.upper);
        q = std::clamp(q, joint.lower, joint.upper);
        if (sign_of(side) * v > 0) v = 0;
      }
      break;
    }
    const int before = blows;
    const double covered = advance_to_event(left);
    if (!finite()) break;
    keep_inside();
    left -= covered;
    if (left <= 1e-14 * dt && blows == before && covered > 0) left = 0;
    if (left <= 0) break;
    std::swap(state, next);
    time += covered;
    if (blows > before) continue;  // a release: torques of the others have not changed
    meet_stops(time);
    // A joint at rest that goes neither into its stop now nor away from it soon would meet it again and
    // again.
    if (blows > before || covered > kNoTime * dt) {
      std::fill(stubborn.begin(), stubborn.end(), 0);
    } else if (met >= 0) {
      const auto i = static_cast<std::size_t>(met);
      double& rate = state.qd[static_cast<std::size_t>(limited[i].v)];
      if (std::abs(rate) <= kResting) {
        rate = 0;
        stubborn[i] = 1;
      }
    }
    lean_on_stops(time);
  }
  std::swap(begin, state);  // step() takes `next` over, or leaves what there was
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
