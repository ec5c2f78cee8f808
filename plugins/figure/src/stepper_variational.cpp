// Discrete mechanics: the end of a step is where the momenta between both poses agree with those the step
// began with, (17) to (20) of doc/dynamics.md. Found by Newton's method with the inertia of the beginning,
// whose articulated form answers each residual in O(N).
#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "stepper_impl.h"
#include "variational_step.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr int kMostRounds = 40, kRoundsToDescend = 12;
constexpr double kDescended = 1e-2;    // rad or m: by then
constexpr double kSolved = 1e-14;      // of the largest increment and a hundredth rad or m
constexpr double kAcceptable = 1e-11;  // where roundings end the search
// Roundings weigh more where a light link carries heavy ones: a search that has come so near and no nearer
// for so many rounds has met them.
constexpr double kStalled = 1e-6;
constexpr int kStalledRounds = 5;
constexpr int kMostHalvings = 6;

}  // namespace

bool FigureStepper::Impl::solve_variational(double dt) {
  const FigureModel& model = dynamics.model();
  const std::size_t n = state.qd.size();
  VariationalStep& mechanics = *variational;
  std::fill(change.begin(), change.end(), 0.0);
  if (!standing.empty()) prescribe(time, state, acceleration);
  const Vec3 gravity = dynamics.gravity(), base = dynamics.base_acceleration();
  mechanics.begin(state.q.data(), state.qd.data(), gravity - base);
  dynamics.set_implicit_time(0.5 * dt);
  dynamics.forward(state.q.data(), state.qd.data(), nullptr, acceleration.data());
  for (std::size_t k = 0; k < n; ++k) increment[k] = dt * (state.qd[k] + 0.5 * dt * acceleration[k]);
  accelerator->restart();
  double before = 1e300, nearest = 1e300;
  int nearest_round = 0;
  bool solved = false;
  for (int round = 0; round < kMostRounds && !solved; ++round) {
    move_by(model, state.q.data(), increment.data(), next.q.data());
    if (!standing.empty()) {
      prescribe(time + dt, next, acceleration);
      for (const int i : standing) {
        if (model.links()[static_cast<std::size_t>(i)].joint != JointKind::kFree) continue;
        const auto q = static_cast<std::size_t>(model.position_offset(i));
        const auto v = static_cast<std::size_t>(model.velocity_offset(i));
        for (std::size_t k = 0; k < 3; ++k) increment[v + 3 + k] = next.q[q + k] - state.q[q + k];
      }
    }
    mechanics.end(next.q.data(), increment.data(), dt);
    mechanics.residual(torque.data());
    dynamics.respond_to_torques(torque.data(), change.data());
    double largest = 0, size = 0;
    for (std::size_t k = 0; k < n; ++k) {
      change[k] *= dt;
      largest = std::max(largest, std::abs(change[k]));
      size = std::max(size, std::abs(increment[k]));
    }
    if (!std::isfinite(largest) || (round >= kRoundsToDescend && largest > kDescended)) break;
    const bool stuck = largest >= 0.3 * before && largest <= kAcceptable * (0.01 + size);
    solved = largest <= kSolved * (0.01 + size) || stuck;
    before = largest;
    if (solved) break;
    if (largest < 0.5 * nearest) {
      nearest = largest;
      nearest_round = round;
    } else if (round - nearest_round >= kStalledRounds && largest <= 2 * nearest &&
               largest <= kStalled * (0.01 + size)) {
      solved = true;
      break;
    }
    accelerator->move(increment, change);
  }
  dynamics.set_implicit_time(0);
  if (!solved) return false;
  // Velocities from the momenta: H qd = p, those of prescribed joints given.
  mechanics.momenta(torque.data());
  if (!standing.empty()) {
    prescribe(time + dt, next, acceleration);
    for (const int i : standing) {
      const int v = model.velocity_offset(i);
      const int count = velocity_count(model.links()[static_cast<std::size_t>(i)].joint);
      std::copy_n(next.qd.begin() + v, count, acceleration.begin() + v);
    }
  }
  dynamics.set_gravity(Vec3::Zero());
  dynamics.set_base_acceleration(Vec3::Zero());
  dynamics.forward(next.q.data(), still.data(), torque.data(), acceleration.data());
  dynamics.set_gravity(gravity);
  dynamics.set_base_acceleration(base);
  std::copy(acceleration.begin(), acceleration.end(), next.qd.begin());
  return true;
}

void FigureStepper::Impl::advance_by_variation(double dt) {
  if (solve_variational(dt)) return;
  // Too far for the search: in halves, each a step of its own.
  const double start = time;
  whole.q = state.q;
  whole.qd = state.qd;
  double done = 0;
  int halvings = 1;
  while (done < dt) {
    const double part = std::min(std::ldexp(dt, -halvings), dt - done);
    if (!solve_variational(part)) {
      if (halvings < kMostHalvings) {
        ++halvings;
        continue;
      }
      advance_by_stages(part, butcher_table(Integrator::kRungeKutta4));
      ++unsolved;
    }
    done += part;
    if (dt - done < 1e-12 * dt) break;
    state.q = next.q;
    state.qd = next.qd;
    time = start + done;
  }
  time = start;
  state.q = whole.q;
  state.qd = whole.qd;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
