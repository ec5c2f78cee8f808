// Viscous friction that slows a joint within a step: explicit stages would throw it back ever harder. Steps
// of Runge-Kutta methods then become extrapolated ones that are implicit in the friction alone; (31) to (33)
// of doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kGentle = 1;  // of h times the fastest decay; explicit stages bear 2.7
constexpr int kMostPowers = 6;

}  // namespace

void FigureStepper::Impl::gather_viscous(const FigureModel& model) {
  viscous.assign(static_cast<std::size_t>(model.velocity_count()), 0.0);
  fastest_decay = 0;
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    if (link.joint == JointKind::kFree || link.damping <= 0) continue;
    std::fill_n(viscous.begin() + model.velocity_offset(i), velocity_count(link.joint), link.damping);
    // No inertia of a joint is less than its armature.
    fastest_decay = std::max(fastest_decay, link.damping / std::max(link.armature, 1e-300));
  }
}

// (38): the largest eigenvalue of H^-1 b, by its powers. Nothing is kept between steps: equal states give
// equal steps.
bool FigureStepper::Impl::rubs_hard(double dt) {
  if (dt * fastest_decay <= kGentle) return false;
  // What is stopped or sticks may be let go within the step.
  const auto links = static_cast<std::size_t>(dynamics.model().link_count());
  for (std::size_t i = 0; i < links; ++i) joints[i] = chosen[i] != 0;
  dynamics.set_dynamic({joints.get(), links});
  std::fill(acceleration.begin(), acceleration.end(), 0.0);
  dynamics.forward(state.q.data(), still.data(), nullptr, acceleration.data());  // for its inertias
  std::fill(change.begin(), change.end(), 1.0);
  bool hard = false;
  for (int round = 0; round < kMostPowers && !hard; ++round) {
    double before = 0, after = 0, size = 0;
    for (std::size_t k = 0; k < viscous.size(); ++k) {
      before += viscous[k] * change[k] * change[k];
      torque[k] = viscous[k] * change[k];
    }
    std::fill(change.begin(), change.end(), 0.0);
    dynamics.respond_to_torques(torque.data(), change.data());
    for (std::size_t k = 0; k < viscous.size(); ++k) {
      after += viscous[k] * change[k] * change[k];
      size = std::max(size, std::abs(change[k]));
    }
    if (!(after > 0)) break;
    const double decay = dt * std::sqrt(after / before);
    hard = decay > kGentle;
    if (round > 0 && decay < 0.1 * kGentle) break;
    for (double& x : change) x /= size;
  }
  set_joints();
  return hard;
}

// (39), (40): steps of Euler's, implicit in the friction, in 1, 2, ... pieces, whose errors are polynomials
// of the piece's length.
double FigureStepper::Impl::part_by_extrapolation(double rest, bool all_of_it) {
  const FigureModel& model = dynamics.model();
  const int row_count = integrator == Integrator::kDormandPrince ? 5 : 4;
  std::vector<double>&moved = rates[1], &rate = rates[0], &sum = rates[2], &a = accelerations[0];
  std::fill(sum.begin(), sum.end(), 0.0);
  std::fill(next.qd.begin(), next.qd.end(), 0.0);
  double length = rest;
  bool known = all_of_it;  // the length
  for (int pieces = 1; pieces <= row_count; ++pieces) {
    double weight = 1;
    for (int other = 1; other <= row_count; ++other) {
      if (other != pieces) weight *= static_cast<double>(pieces) / (pieces - other);
    }
    const double h = length / pieces;
    std::fill(moved.begin(), moved.end(), 0.0);
    std::copy(state.q.begin(), state.q.end(), stage.q.begin());
    std::copy(state.qd.begin(), state.qd.end(), stage.qd.begin());
    dynamics.set_implicit_time(h);
    for (int piece = 0; piece < pieces; ++piece) {
      if (piece > 0) move_by(model, state.q.data(), moved.data(), stage.q.data());
      if (!standing.empty()) prescribe(time + piece * h, stage, a);
      answer(stage, nullptr, a.data());
      if (!known) {
        known = true;
        length = part_of(rest);
        if (length < rest) {  // begin anew
          dynamics.set_implicit_time(0);
          part_by_extrapolation(length, true);
          return length;
        }
      }
      for (std::size_t k = 0; k < pins.size(); ++k) part_impulses[k] += weight * h * pin_loads[k].force;
      for (std::size_t k = 0; k < a.size(); ++k) stage.qd[k] += h * a[k];
      increment_rate(model, moved.data(), stage.qd.data(), rate.data());
      for (std::size_t k = 0; k < rate.size(); ++k) moved[k] += h * rate[k];
    }
    for (std::size_t k = 0; k < sum.size(); ++k) {
      sum[k] += weight * moved[k];
      next.qd[k] += weight * stage.qd[k];
    }
  }
  dynamics.set_implicit_time(0);
  move_by(model, state.q.data(), sum.data(), next.q.data());
  return length;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
