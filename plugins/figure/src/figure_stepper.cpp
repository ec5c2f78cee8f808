#include "softpoint/figure/figure_stepper.h"

#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "runge_kutta.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

PrescribedMotion::~PrescribedMotion() = default;

struct __attribute__((visibility("hidden"))) FigureStepper::Impl {
  Impl(const FigureModel& model, FigureState start, Integrator how)
      : dynamics(model), integrator(how), state(std::move(start)) {
    check_state(model, state);
    next = state;
    stage = state;
    const auto n = static_cast<std::size_t>(model.velocity_count());
    increment.resize(n);
    acceleration.resize(n);
    for (int i = 0; i < 6; ++i) {
      rates[i].resize(n);
      accelerations[i].resize(n);
    }
  }

  // The prescribed joints at a time, in `to`; their accelerations in `qdd`.
  void prescribe(double at, FigureState& to, std::vector<double>& qdd) {
    const FigureModel& model = dynamics.model();
    for (int i = 0; i < model.link_count(); ++i) {
      if (dynamics.dynamic(i)) continue;
      const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
      const auto q = static_cast<std::size_t>(model.position_offset(i));
      const auto v = static_cast<std::size_t>(model.velocity_offset(i));
      for (std::size_t k = 0; k < static_cast<std::size_t>(position_count(kind)); ++k)
        to.q[q + k] = state.q[q + k];
      for (std::size_t k = 0; k < static_cast<std::size_t>(velocity_count(kind)); ++k)
        to.qd[v + k] = qdd[v + k] = 0;
    }
    if (motion != nullptr) motion->evaluate(at, to.q.data(), to.qd.data(), qdd.data());
  }

  void step_by_stages(double dt);
  void step_as_paper(double dt);

  FigureDynamics dynamics;
  Integrator integrator;
  FigureState state, next, stage;
  const PrescribedMotion* motion = nullptr;
  double time = 0;
  long long guard_fired = 0;
  std::vector<double> increment, acceleration;
  std::vector<double> rates[6], accelerations[6];
};

void FigureStepper::Impl::step_by_stages(double dt) {
  const ButcherTable& table = butcher_table(integrator);
  const FigureModel& model = dynamics.model();
  const std::size_t n = state.qd.size();
  const auto look_ahead = [&](const double* weights, int count, FigureState& to) {
    for (std::size_t k = 0; k < n; ++k) {
      double d = 0, v = 0;
      for (int j = 0; j < count; ++j) {
        d += weights[j] * rates[j][k];
        v += weights[j] * accelerations[j][k];
      }
      increment[k] = dt * d;
      to.qd[k] = state.qd[k] + dt * v;
    }
    move_by(model, state.q.data(), increment.data(), to.q.data());
  };
  for (int i = 0; i < table.stages; ++i) {
    look_ahead(table.a[i], i, stage);
    prescribe(time + table.c[i] * dt, stage, accelerations[i]);
    dynamics.forward(stage.q.data(), stage.qd.data(), nullptr, accelerations[i].data());
    increment_rate(model, increment.data(), stage.qd.data(), rates[i].data());
  }
  look_ahead(table.b, table.stages, next);
}

// Equations (5) and (6) of the paper.
void FigureStepper::Impl::step_as_paper(double dt) {
  prescribe(time, state, acceleration);
  dynamics.forward(state.q.data(), state.qd.data(), nullptr, acceleration.data());
  for (std::size_t k = 0; k < state.qd.size(); ++k) {
    next.qd[k] = state.qd[k] + dt * acceleration[k];
    increment[k] = dt * next.qd[k];
  }
  move_by(dynamics.model(), state.q.data(), increment.data(), next.q.data());
}

FigureStepper::FigureStepper(const FigureModel& model, FigureState state, Integrator integrator)
    : impl_(std::make_unique<Impl>(model, std::move(state), integrator)) {}
FigureStepper::~FigureStepper() = default;
FigureStepper::FigureStepper(FigureStepper&&) noexcept = default;
FigureStepper& FigureStepper::operator=(FigureStepper&&) noexcept = default;

FigureDynamics& FigureStepper::dynamics() { return impl_->dynamics; }
const FigureDynamics& FigureStepper::dynamics() const { return impl_->dynamics; }
void FigureStepper::set_prescribed_motion(const PrescribedMotion* motion) { impl_->motion = motion; }
const FigureState& FigureStepper::state() const { return impl_->state; }
double FigureStepper::time() const { return impl_->time; }
long long FigureStepper::guard_fired() const { return impl_->guard_fired; }

void FigureStepper::set_state(FigureState state) {
  check_state(impl_->dynamics.model(), state);
  impl_->state = std::move(state);
}

void FigureStepper::set_time(double time) {
  check_range("time", time, -1e9, 1e9);
  impl_->time = time;
}

bool FigureStepper::step(double dt) {
  check_range("dt", dt, 1e-9, 1);
  Impl& m = *impl_;
  if (m.integrator == Integrator::kPaper) {
    m.step_as_paper(dt);
  } else {
    m.step_by_stages(dt);
  }
  m.prescribe(m.time + dt, m.next, m.acceleration);
  const auto finite = [](double x) { return std::isfinite(x); };
  m.time += dt;
  if (!std::all_of(m.next.q.begin(), m.next.q.end(), finite) ||
      !std::all_of(m.next.qd.begin(), m.next.qd.end(), finite)) {
    ++m.guard_fired;
    return false;
  }
  std::swap(m.state, m.next);
  return true;
}

double FigureStepper::energy() {
  Impl& m = *impl_;
  m.dynamics.place(m.state.q.data(), m.state.qd.data());
  const FigureMechanics sums = m.dynamics.mechanics();
  return sums.kinetic_energy + sums.potential_energy;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
