// Explicit Runge-Kutta steps on the group, in as many parts as the joints' turning asks for.
#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// Stages stay bounded up to 2.8 rad of an oscillation a step. At 1 the energy of limp arms with light hands
// grew by 1e-2 J of 6 within seconds, at a half by 2e-4.
constexpr double kMostTurn = 0.5;  // rad
constexpr int kMostParts = 1024;

}  // namespace

// From the first stage: rates of the state and what they will be at the end of `dt`.
double FigureStepper::Impl::part_of(double dt) const {
  double rate = 0, gain = 0;
  for (const std::size_t k : turning) {
    rate = std::max(rate, std::abs(state.qd[k]));
    gain = std::max(gain, std::abs(accelerations[0][k]));
  }
  const double turn = dt * (rate + 0.5 * dt * gain);
  if (!(turn > kMostTurn)) return dt;
  // The longest part that turns no further: rate h + gain h^2 / 2 = kMostTurn.
  const double part = 2 * kMostTurn / (rate + std::sqrt(rate * rate + 2 * gain * kMostTurn));
  return dt / std::min(std::ceil(dt / part), static_cast<double>(kMostParts));
}

double FigureStepper::Impl::part_by_stages(double rest, bool all_of_it, const ButcherTable& table) {
  const FigureModel& model = dynamics.model();
  const std::size_t n = state.qd.size();
  const auto look_ahead = [&](double h, const double* weights, int count, FigureState& to) {
    for (std::size_t k = 0; k < n; ++k) {
      double d = 0, v = 0;
      for (int j = 0; j < count; ++j) {
        d += weights[j] * rates[j][k];
        v += weights[j] * accelerations[j][k];
      }
      increment[k] = h * d;
      to.qd[k] = state.qd[k] + h * v;
    }
    move_by(model, state.q.data(), increment.data(), to.q.data());
  };
  double h = rest;
  for (int i = 0; i < table.stages; ++i) {
    look_ahead(h, table.a[i], i, stage);
    if (!standing.empty()) prescribe(time + table.c[i] * h, stage, accelerations[i]);
    answer(stage, nullptr, accelerations[i].data());
    if (i == 0 && !all_of_it) h = part_of(rest);
    for (std::size_t k = 0; k < pins.size(); ++k) part_impulses[k] += h * table.b[i] * pin_loads[k].force;
    increment_rate(model, increment.data(), stage.qd.data(), rates[i].data());
  }
  look_ahead(h, table.b, table.stages, next);
  return h;
}

void FigureStepper::Impl::advance_by_stages(double dt, const ButcherTable& table) {
  const double start = time;
  double rest = dt;
  for (int part = 1;; ++part) {
    const bool last = part >= kMostParts;
    const double h = rubbing_hard ? part_by_extrapolation(rest, last) : part_by_stages(rest, last, table);
    if (h >= rest || !finite()) break;
    if (part == 1) parts_from = state;
    ++parts;
    state.q = next.q;
    state.qd = next.qd;
    rest -= h;
    time = start + (dt - rest);
    if (!standing.empty()) prescribe(time, state, acceleration);
  }
  if (rest < dt) {
    state.q = parts_from.q;
    state.qd = parts_from.qd;
    time = start;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
