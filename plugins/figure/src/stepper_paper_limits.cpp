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
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] == Stop::kFree) continue;
      const auto q = static_cast<std::size_t>(limited[i].q), v = static_cast<std::size_t>(limited[i].v);
      const double limit = stops[i] == Stop::kLower ? limited[i].lower : limited[i].upper;
      stage.qd[v] = state.qd[v];
      acceleration[v] = ((limit - state.q[q]) / dt - state.qd[v]) / dt;  // (7)
    }
    dynamics.forward(stage.q.data(), stage.qd.data(), nullptr, acceleration.data());  // (5) of 2.4, then (11)
    ++counts.passes;
    for (std::size_t k = 0; k < state.qd.size(); ++k) next.qd[k] = stage.qd[k] + dt * acceleration[k];  // (5)
    for (std::size_t k = 0; k < state.qd.size(); ++k) increment[k] = std::exp(dt * friction[k]);
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] != Stop::kFree) increment[static_cast<std::size_t>(limited[i].v)] = 1;
    }
    for (std::size_t k = 0; k < state.qd.size(); ++k) {
      next.qd[k] *= increment[k];  // step (7)
      increment[k] = dt * next.qd[k];
    }
    move_by(dynamics.model(), stage.q.data(), increment.data(), next.q.data());  // (6)
    finished = true;
    for (std::size_t i = 0; i < limited.size(); ++i) {
      if (stops[i] != Stop::kFree || !chosen[static_cast<std::size_t>(limited[i].link)]) continue;
      const double q = next.q[static_cast<std::size_t>(limited[i].q)];
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
    next.q[static_cast<std::size_t>(limited[i].q)] = limit;
    const double side = static_cast<double>(stops[i]);
    counts.wrong_sign += side * torque[static_cast<std::size_t>(limited[i].v)] > 0;
    stops[i] = Stop::kFree;
  }
  if (!standing.empty()) {
    set_joints();
    if (!standing.empty()) prescribe(time + dt, next, acceleration);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
