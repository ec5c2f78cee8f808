// Steps (1) to (11) of the paper, section 2.4. Its loop is read cumulatively: a joint that was set to its
// limit stays so for the rest of the step. Taken literally, only the last pass counting, it need not end.
#include <cmath>

#include "group_motion.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

void FigureStepper::Impl::step_as_paper_with_limits(double dt) {
  constexpr double kSlack = 1e-12;  // or a joint set to its limit would miss it by a rounding
  for (Stop& stop : stops) stop = Stop::kFree;
  const std::size_t most = limited.size() + 1;
  bool finished = false;
  for (std::size_t round = 0; round < most && !finished; ++round) {
    set_joints();
    stage.q = state.q;
    stage.qd = state.qd;
    if (!standing.empty()) prescribe(time, stage, acceleration);
    row_wanted.clear();
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] == Stop::kFree) continue;
      const auto v = static_cast<std::size_t>(limited[i].v);
      const double limit = stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper;
      // (7); of a swing by its angle's share of the cone, whose rate is that of its row by that share.
      const double place = place_of(limited[i], state), rate = rate_of(limited[i], state);
      double way = limit - place;
      if (limited[i].part == Limited::Part::kSwing) {
        const double size = ball_ranges[static_cast<std::size_t>(limited[i].ball)].size();
        const double share = std::sqrt(std::max(0.0, 1 + 2 * place / size));
        way = share * (1 - share) * size;
      }
      const double wanted = (way / dt - rate) / dt;
      if (limited[i].part != Limited::Part::kNumber) {
        row_wanted.push_back(wanted);
        continue;
      }
      stage.qd[v] = state.qd[v];
      acceleration[v] = wanted;
    }
    dynamics.forward(stage.q.data(), stage.qd.data(), nullptr, acceleration.data());  // (5) of 2.4, then (11)
    if (!row_wanted.empty()) {
      list_rows(state);
      keep_rows_to(state, acceleration.data(), row_wanted);
    }
    ++counts.passes;
    for (std::size_t k = 0; k < state.qd.size(); ++k) next.qd[k] = stage.qd[k] + dt * acceleration[k];  // (5)
    for (std::size_t k = 0; k < state.qd.size(); ++k) increment[k] = std::exp(dt * friction[k]);
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] == Stop::kFree) continue;
      std::fill_n(increment.begin() + limited[i].v, limited[i].part == Limited::Part::kNumber ? 1 : 3, 1.0);
    }
    for (std::size_t k = 0; k < state.qd.size(); ++k) {
      next.qd[k] *= increment[k];  // step (7)
      increment[k] = dt * next.qd[k];
    }
    move_by(dynamics.model(), stage.q.data(), increment.data(), next.q.data());  // (6)
    finished = true;
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] != Stop::kFree || !chosen[static_cast<std::size_t>(limited[i].link)]) continue;
      const double q = next_place(limited[i]);
      if (q < limited[i].lower - kSlack) stops[i] = Stop::kLower;
      if (q > limited[i].upper + kSlack) stops[i] = Stop::kUpper;
      if (stops[i] != Stop::kFree) finished = false;
    }
  }
  counts.unfinished += !finished;
  bool stopped = false;
  for (const Stop stop : stops) stopped = stopped || stop != Stop::kFree;
  if (!stopped) return;
  dynamics.inverse(stage.q.data(), stage.qd.data(), acceleration.data(), torque.data());
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (stops[i] == Stop::kFree) continue;
    const double limit = stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper;
    put(limited[i], limit, next);  // a ball's numbers do not go straight: theirs is missed by order dt^2
    counts.wrong_sign += static_cast<double>(stops[i]) * pull_of(i) > 0;
    stops[i] = Stop::kFree;
  }
  if (!standing.empty()) {
    set_joints();
    if (!standing.empty()) prescribe(time + dt, next, acceleration);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
