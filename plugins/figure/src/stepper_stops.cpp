// Ranges of joints as inelastic stops, exactly: impacts and releases are located inside the step, which goes
// on from each of them. Equations (13) to (16) of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "stops_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr std::size_t kKeptEvents = 64;
constexpr double kNoTime = 1e-12;  // of a step
constexpr double kResting = 1e-9;  // rad/s or m/s
constexpr int kMaxParts = 1000;    // of a step between events

}  // namespace

void FigureStepper::Impl::note(double at, int joint, bool impact) {
  const auto i = static_cast<std::size_t>(joint);
  ++(impact ? counts.impacts : counts.releases);
  ++blows;
  if (events.size() < kKeptEvents) {
    events.push_back({at, limited[i].link, static_cast<int>(candidates[i]), impact,
                      limited[i].part == Limited::Part::kSwing});
  }
}

// What goes through a stop by no more than a rounding stands on it.
void FigureStepper::Impl::keep_inside() {
  for (const Limited& joint : limited) {
    if (!chosen[static_cast<std::size_t>(joint.link)]) continue;
    const double q = place_of(joint, next);
    if (q < joint.lower || q > joint.upper) put(joint, std::clamp(q, joint.lower, joint.upper), next);
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
    touching = touching || touched(place_of(joint, state), joint.lower, joint.upper) != Stop::kFree;
  }
  if (touching) {
    meet_stops(time);
    lean_on_stops(time);
  }
  for (int part = 0; left > 0; ++part) {
    if (part >= kMaxParts) {  // stops the joints where they go through
      ++counts.capped;
      advance(left);
      take_part();
      for (const Limited& joint : limited) {
        const double q = place_of(joint, next);
        const Stop side = touched(q, joint.lower, joint.upper);
        if (q < joint.lower || q > joint.upper) put(joint, std::clamp(q, joint.lower, joint.upper), next);
        if (sign_of(side) * rate_of(joint, next) > 0) calm(joint, next);
      }
      break;
    }
    const int before = blows;
    const double covered = advance_to_event(std::min(left, longest_part()));
    take_part();
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
      if (std::abs(rate_of(limited[i], state)) <= kResting) {
        calm(limited[i], state);
        stubborn[i] = 1;
      }
    }
    lean_on_stops(time);
  }
  std::swap(begin, state);  // step() takes `next` over, or leaves what there was
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
