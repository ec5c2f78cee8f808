// When joints meet their stops and when they leave them: (13) and (16) of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "cubic_crossing.h"
#include "stops_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr int kMaxLocating = 40;  // re-steps for one event
constexpr double kGraze = 1e-14;  // rad or m: through a stop by no more is touching it

}  // namespace

bool FigureStepper::Impl::crosses(std::size_t i, double length, double& t, double& beyond) {
  const Limited& joint = limited[i];
  if (stops[i] != Stop::kFree || !chosen[static_cast<std::size_t>(joint.link)]) return false;
  const double from = place_of(joint, state), rate = rate_of(joint, state);
  const double until = next_place(joint), last_rate = rate_of(joint, next);
  bool found = false;
  for (const double side : {-1.0, 1.0}) {
    const double bound = side < 0 ? joint.lower : joint.upper;
    double first = 0, past = 0;
    const CubicSpan span{side * (from - bound), side * rate, side * (until - bound), side * last_rate,
                         length};
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
  const double side = sign_of(candidates[i]), bound = side < 0 ? joint.lower : joint.upper;
  const double enough = 1e-15 * (1 + std::abs(bound));
  const auto gap = [&](double at) {
    advance(at);
    ++counts.resteps;
    return side * (next_place(joint) - bound);
  };
  if (!(gap(beyond) > kGraze)) return -1;
  double low = 0, high = beyond;
  for (int k = 0; k < kMaxLocating; ++k) {
    const double g = gap(t);
    (g > 0 ? high : low) = t;
    if (std::abs(g) <= enough || high - low <= 1e-16 * high || k + 1 == kMaxLocating) break;
    const double rate = side * rate_of(joint, next);
    const double better = t - g / rate;
    t = rate > 0 && better > low && better < high ? better : 0.5 * (low + high);
  }
  put(joint, bound, next);
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
      const double p = sign_of(stops[i]) * pull_of(i);
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

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
