#include "softpoint/figure/figure_stepper.h"

#include <algorithm>
#include <cmath>

#include "group_motion.h"
#include "softpoint/core/error.h"
#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

PrescribedMotion::~PrescribedMotion() = default;

FigureStepper::Impl::Impl(const FigureModel& model, FigureState start, Integrator how)
    : dynamics(model), integrator(how), state(std::move(start)) {
  check_state(model, state);
  next = stage = begin = whole = parts_from = before_friction = state;
  const auto n = static_cast<std::size_t>(model.velocity_count());
  const auto links = static_cast<std::size_t>(model.link_count());
  for (std::vector<double>* v : {&increment, &acceleration, &torque, &still, &friction, &change, &dry_torque})
    v->resize(n);
  for (int i = 0; i < 6; ++i) {
    rates[i].resize(n);
    accelerations[i].resize(n);
  }
  gather_viscous(model);
  chosen.assign(links, 1);
  joints = std::make_unique<bool[]>(links);
  standing.reserve(links);
  events.reserve(64);
  for (int i = 0; i < model.link_count(); ++i) {
    const Link& link = model.links()[static_cast<std::size_t>(i)];
    const int q = model.position_offset(i), v = model.velocity_offset(i);
    const bool one = link.joint == JointKind::kHinge || link.joint == JointKind::kPrismatic;
    for (int k = 0; k < velocity_count(link.joint); ++k) {
      const bool turns = link.joint == JointKind::kHinge || link.joint == JointKind::kBall ||
                         (link.joint == JointKind::kFree && k < 3);
      if (turns) turning.push_back(static_cast<std::size_t>(v + k));
    }
    if (one && has_range(link)) {
      limited.push_back({i, q, v, link.lower, link.upper, Limited::Part::kNumber, -1});
    } else if (has_range(link)) {
      const int ball = static_cast<int>(ball_ranges.size());
      ball_ranges.emplace_back(link);
      limited.push_back({i, q, v, -1e9, 0, Limited::Part::kSwing, ball});
      if (link.lower > -1e9)
        limited.push_back({i, q, v, link.lower, link.upper, Limited::Part::kTwist, ball});
    }
    if (one && link.friction > 0) {
      const bool ranged = !limited.empty() && limited.back().link == i;
      dry.push_back({i, static_cast<std::size_t>(model.velocity_offset(i)),
                     ranged ? static_cast<int>(limited.size()) - 1 : -1, link.friction});
    }
  }
  seen.resize(limited.size());
  ball_pulls.assign(limited.size(), 0.0);
  make_room_for_rows();
  stops.assign(limited.size(), Stop::kFree);
  candidates = leaning = stops;
  grazing.assign(limited.size(), 0);
  stubborn = grazing;
  let_go.assign(limited.size(), 0);
  slides.assign(dry.size(), 0);
  held.assign(dry.size(), 0);
  if (integrator == Integrator::kVariational) {
    variational = std::make_unique<VariationalStep>(model);
    accelerator = std::make_unique<Anderson>(n);
  }
  set_joints();
}

void FigureStepper::Impl::set_joints() {
  const std::size_t links = chosen.size();
  for (std::size_t i = 0; i < links; ++i) joints[i] = chosen[i] != 0;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    if (stops[i] != Stop::kFree && limited[i].part == Limited::Part::kNumber)
      joints[static_cast<std::size_t>(limited[i].link)] = false;
  }
  for (std::size_t i = 0; i < dry.size(); ++i) {
    if (held[i]) joints[static_cast<std::size_t>(dry[i].link)] = false;
  }
  standing.clear();
  for (std::size_t i = 0; i < links; ++i) {
    if (!joints[i]) standing.push_back(static_cast<int>(i));
  }
  dynamics.set_dynamic({joints.get(), links});
}

void FigureStepper::Impl::prescribe(double at, FigureState& to, std::vector<double>& qdd) {
  const FigureModel& model = dynamics.model();
  for (const int i : standing) {
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

void FigureStepper::Impl::advance(double dt) {
  std::fill(part_impulses.begin(), part_impulses.end(), Vec3::Zero());
  if (integrator == Integrator::kPaper) {
    advance_as_paper(dt);
  } else if (integrator == Integrator::kVariational) {
    advance_by_variation(dt);
  } else {
    advance_by_stages(dt, butcher_table(integrator));
  }
  if (!standing.empty()) prescribe(time + dt, next, acceleration);
  settle_rows(next);
}

// Equations (5) and (6) of the paper.
void FigureStepper::Impl::advance_as_paper(double dt) {
  if (!standing.empty()) prescribe(time, state, acceleration);
  dynamics.set_implicit_time(dt);
  answer(state, nullptr, acceleration.data());
  for (std::size_t k = 0; k < pins.size(); ++k) part_impulses[k] += dt * pin_loads[k].force;
  dynamics.set_implicit_time(0);
  for (std::size_t k = 0; k < state.qd.size(); ++k) {
    next.qd[k] = (state.qd[k] + dt * acceleration[k]) * std::exp(dt * friction[k]);
    increment[k] = dt * next.qd[k];
  }
  move_by(dynamics.model(), state.q.data(), increment.data(), next.q.data());
}

bool FigureStepper::Impl::finite() const {
  const auto is = [](double x) { return std::isfinite(x); };
  return std::all_of(next.q.begin(), next.q.end(), is) && std::all_of(next.qd.begin(), next.qd.end(), is);
}

void FigureStepper::Impl::move(double dt) {
  if (limits == LimitMode::kExact) {
    step_with_stops(dt);
  } else if (limits == LimitMode::kPaper) {
    step_as_paper_with_limits(dt);
  } else {
    advance(dt);
    take_part();
  }
}

bool FigureStepper::step(double dt) {
  check_range("dt", dt, 1e-9, 1);
  Impl& m = *impl_;
  m.events.clear();
  const double end = m.time + dt;
  std::fill(m.pin_impulses.begin(), m.pin_impulses.end(), Vec3::Zero());
  const bool stages = m.integrator == Integrator::kRungeKutta4 || m.integrator == Integrator::kDormandPrince;
  m.rubbing_hard = stages && m.rubs_hard(dt);
  if (!m.dry.empty()) {
    m.begin_with_friction(dt);
    m.hold_at_rest();
  }
  if (m.pins.empty()) {
    m.move(dt);
  } else {
    m.move_with_pins(dt);
  }
  m.time = end;
  const bool good = m.finite();
  if (!m.dry.empty()) m.end_with_friction(dt, good);
  if (!good) {
    ++m.guard_fired;
    return false;
  }
  std::swap(m.state, m.next);
  return true;
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
long long FigureStepper::unsolved() const { return impl_->unsolved; }
long long FigureStepper::parts() const { return impl_->parts; }
LimitMode FigureStepper::limits() const { return impl_->limits; }
std::span<const Vec3> FigureStepper::pin_impulses() const { return impl_->pin_impulses; }
std::span<const LimitEvent> FigureStepper::events() const { return impl_->events; }
const LimitCounts& FigureStepper::limit_counts() const { return impl_->counts; }

double FigureStepper::energy() {
  Impl& m = *impl_;
  m.dynamics.place(m.state.q.data(), m.state.qd.data());
  const FigureMechanics sums = m.dynamics.mechanics();
  return sums.kinetic_energy + sums.potential_energy;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
