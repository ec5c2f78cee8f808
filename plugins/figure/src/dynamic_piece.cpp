#include "dynamic_piece.h"

#include <algorithm>
#include <cmath>

#include "ball_range.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
FigureModel with_ranges_of(const FigureModel& model, const std::vector<int>& links) {
  std::vector<Link> result = model.links();
  for (int i = 0; i < model.link_count(); ++i) {
    if (std::find(links.begin(), links.end(), i) != links.end()) continue;
    open_range(result[static_cast<std::size_t>(i)]);
  }
  return FigureModel(std::move(result));
}

FigureState state_inside(const FigureModel& model) {
  FigureState inside = rest_state(model);
  for (int i = 0; i < model.link_count(); ++i) {
    put_inside(model.links()[static_cast<std::size_t>(i)], inside.q.data() + model.position_offset(i));
  }
  return inside;
}

FigureModel with_friction_of(FigureModel model, const std::vector<int>& links,
                             const AnimationSettings& settings) {
  if (settings.integrator == Integrator::kPaper || settings.paper_friction.empty()) return model;
  constexpr double kReference = 1.0 / 30;  // s, of the factors
  constexpr double kLeastFactor = 1e-6;    // 0 would be endless friction
  const auto count = static_cast<std::size_t>(model.link_count());
  const auto flags = std::make_unique<bool[]>(count);
  for (const int link : links) flags[static_cast<std::size_t>(link)] = true;
  FigureDynamics dynamics(model);
  dynamics.set_dynamic({flags.get(), count});
  const FigureState pose = state_inside(model);
  std::vector<double> accelerations(pose.qd.size(), 0.0), torque(pose.qd.size(), 0.0);
  dynamics.forward(pose.q.data(), pose.qd.data(), nullptr, accelerations.data());
  std::vector<Link> result = model.links();
  for (const auto& [link, factor] : settings.paper_friction) {
    Link& joint = result[static_cast<std::size_t>(link)];
    const int dofs = velocity_count(joint.joint);
    if (!flags[static_cast<std::size_t>(link)] || joint.joint == JointKind::kFree || dofs == 0) continue;
    double mobility = 0;  // (H^-1)_ii; of a ball the mean
    for (int k = 0; k < dofs; ++k) {
      const auto v = static_cast<std::size_t>(model.velocity_offset(link) + k);
      torque[v] = 1;
      dynamics.respond_to_torques(torque.data(), accelerations.data());
      torque[v] = 0;
      mobility += accelerations[v] / dofs;
    }
    if (mobility > 0) joint.damping -= std::log(std::max(factor, kLeastFactor)) / (kReference * mobility);
  }
  return FigureModel(std::move(result));
}

void BaseRule::apply(const FigureModel& model, double* q, double* qd, double* qdd) const {
  if (pinned == nullptr) return;
  const PointMotion now = pinned->evaluate(point, q, qd, qdd);
  const int at = model.position_offset(0), v = model.velocity_offset(0) + 3;
  for (int k = 0; k < 3; ++k) {
    q[at + k] += place[k] - now.position[k];
    qd[v + k] -= now.velocity[k];
    if (qdd != nullptr) qdd[v + k] -= now.acceleration[k];
  }
}

void BaseRule::fly(const FigureModel& model, double now, double* q, double* qd, double* qdd) const {
  const int at = model.position_offset(0), v = model.velocity_offset(0) + 3;
  const double t = now - time;
  for (int k = 0; k < 3; ++k) {
    q[at + k] = place[k] + t * rate[k] + 0.5 * t * t * gain[k];
    qd[v + k] = rate[k] + t * gain[k];
    qdd[v + k] = gain[k];
  }
}

void KeyedMotion::evaluate(double time, double* q, double* qd, double* qdd) const {
  for (const int link : links) {
    const std::optional<TrackSpline>& spline = splines_[static_cast<std::size_t>(link)];
    const int at = model_.position_offset(link), v = model_.velocity_offset(link);
    if (spline) spline->evaluate(time, q + at, qd + v, qdd + v);
  }
  base.apply(model_, q, qd, qdd);
  if (base.flies) base.fly(model_, time, q, qd, qdd);
}

DynamicPiece::DynamicPiece(const FigureModel& model, std::vector<int> links,
                           const AnimationSettings& settings,
                           const std::vector<std::optional<TrackSpline>>& splines)
    : model_(with_friction_of(with_ranges_of(model, links), links, settings)),
      links_(std::move(links)),
      is_dynamic_(static_cast<std::size_t>(model.link_count()), 0),
      substeps_(settings.substeps),
      splines_(splines),
      motion_(model, splines),
      stepper_(model_, rest_state(model_), settings.integrator),
      last_acceleration_(static_cast<std::size_t>(model.velocity_count()), 0.0) {
  const auto count = static_cast<std::size_t>(model.link_count());
  for (const int link : links_) is_dynamic_[static_cast<std::size_t>(link)] = 1;
  // Whatever hangs on a dynamic joint, and what it hangs on itself.
  std::vector<char> needed = is_dynamic_;
  for (std::size_t i = 0; i < count; ++i) {
    const int parent = model.links()[i].parent;
    if (parent >= 0 && needed[static_cast<std::size_t>(parent)]) needed[i] = 1;
  }
  for (std::size_t i = count; i-- > 0;) {
    const int parent = model.links()[i].parent;
    if (needed[i] && parent >= 0) needed[static_cast<std::size_t>(parent)] = 1;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (needed[i]) needed_.push_back(static_cast<int>(i));
  }
  const auto flags = std::make_unique<bool[]>(count);
  for (std::size_t i = 0; i < count; ++i) flags[i] = is_dynamic_[i] != 0;
  stepper_.dynamics().set_gravity(settings.gravity);
  stepper_.set_dynamic({flags.get(), count});
  for (const auto& [link, factor] : settings.paper_friction) stepper_.set_paper_friction(link, factor);
  stepper_.set_prescribed_motion(&motion_);
  stepper_.set_state(state_inside(model_));
  stepper_.set_limits(settings.limits);
}

void DynamicPiece::advance(std::size_t tick, double time, double dt, const BaseRule& base,
                           const FigureState& from, bool want_acceleration, FigureState& next,
                           AnimationCounts& counts) {
  // Everything that the frame depends on.
  motion_.base = base;
  motion_.links.clear();
  inputs_.clear();
  inputs_.insert(inputs_.end(), {time, dt, want_acceleration ? 1.0 : 0.0});
  const auto take = [&](int link) {
    const auto i = static_cast<std::size_t>(link);
    if (is_dynamic_[i]) {
      const JointKind kind = model_.links()[i].joint;
      const auto q = from.q.begin() + model_.position_offset(link);
      const auto qd = from.qd.begin() + model_.velocity_offset(link);
      inputs_.insert(inputs_.end(), q, q + position_count(kind));
      inputs_.insert(inputs_.end(), qd, qd + velocity_count(kind));
      return;
    }
    if (!splines_[i]) return;
    motion_.links.push_back(link);
    splines_[i]->append_numbers(time, time + dt, inputs_);
  };
  for (const int link : needed_) take(link);
  if (base.pinned != nullptr) {
    for (int k = 0; k < 3; ++k) inputs_.insert(inputs_.end(), {base.point[k], base.place[k]});
    inputs_.push_back(base.pinned->links().back());
    for (const int link : base.pinned->links()) {
      if (std::find(needed_.begin(), needed_.end(), link) == needed_.end()) take(link);
    }
  }
  if (base.flies) {
    for (int k = 0; k < 3; ++k) inputs_.insert(inputs_.end(), {base.place[k], base.rate[k], base.gain[k]});
  }
  if (memories_.size() <= tick) memories_.resize(tick + 1);
  Memory& memory = memories_[tick];
  if (memory.inputs == inputs_) {
    ++counts.reused_steps;
  } else {
    simulate(time, dt, from, want_acceleration, memory, counts);
    memory.inputs = inputs_;
  }
  std::size_t q = 0, v = 0;
  for (const int link : links_) {
    const JointKind kind = model_.links()[static_cast<std::size_t>(link)].joint;
    for (int k = 0; k < position_count(kind); ++k) {
      next.q[static_cast<std::size_t>(model_.position_offset(link) + k)] = memory.q[q++];
    }
    for (int k = 0; k < velocity_count(kind); ++k, ++v) {
      const auto to = static_cast<std::size_t>(model_.velocity_offset(link) + k);
      next.qd[to] = memory.qd[v];
      if (want_acceleration) last_acceleration_[to] = memory.qdd[v];
    }
  }
}

void DynamicPiece::simulate(double time, double dt, const FigureState& from, bool want_acceleration,
                            Memory& memory, AnimationCounts& counts) {
  const long long before = stepper_.dynamics().counts().calls;
  start_ = from;
  for (const int link : links_) {  // a range may be missed by a rounding, and by no more
    const Link& joint = model_.links()[static_cast<std::size_t>(link)];
    double* q = start_.q.data() + model_.position_offset(link);
    if (outside_range(joint, q) < 1e-9) put_inside(joint, q);
  }
  stepper_.set_state(start_);
  stepper_.set_time(time);
  for (int k = 0; k < substeps_; ++k) {
    stepper_.set_time(time + dt * k / substeps_);
    counts.guard_fired += !stepper_.step(dt / substeps_);
  }
  ++counts.dynamic_steps;
  const FigureState& end = stepper_.state();
  std::vector<double> qdd;
  if (want_acceleration) {
    qdd.assign(end.qd.size(), 0.0);
    start_ = end;
    motion_.evaluate(time + dt, start_.q.data(), start_.qd.data(), qdd.data());
    stepper_.dynamics().forward(start_.q.data(), start_.qd.data(), nullptr, qdd.data());
  }
  memory.q.clear();
  memory.qd.clear();
  memory.qdd.clear();
  for (const int link : links_) {
    const JointKind kind = model_.links()[static_cast<std::size_t>(link)].joint;
    const auto q = end.q.begin() + model_.position_offset(link);
    const auto v = static_cast<std::ptrdiff_t>(model_.velocity_offset(link));
    memory.q.insert(memory.q.end(), q, q + position_count(kind));
    memory.qd.insert(memory.qd.end(), end.qd.begin() + v, end.qd.begin() + v + velocity_count(kind));
    if (want_acceleration) {
      memory.qdd.insert(memory.qdd.end(), qdd.begin() + v, qdd.begin() + v + velocity_count(kind));
    }
  }
  counts.forward_calls += stepper_.dynamics().counts().calls - before;
}

std::vector<double> DynamicPiece::acceleration(int link) const {
  const auto v = last_acceleration_.begin() + model_.velocity_offset(link);
  return {v, v + velocity_count(model_.links()[static_cast<std::size_t>(link)].joint)};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
