#include "softpoint/figure/figure_dynamics.h"

#include <algorithm>

#include "figure_dynamics_impl.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

FigureDynamics::FigureDynamics(const FigureModel& model) : impl_(std::make_unique<Impl>(model)) {}
FigureDynamics::~FigureDynamics() = default;
FigureDynamics::FigureDynamics(FigureDynamics&&) noexcept = default;
FigureDynamics& FigureDynamics::operator=(FigureDynamics&&) noexcept = default;

const FigureModel& FigureDynamics::model() const { return impl_->model; }

void FigureDynamics::set_dynamic(std::span<const bool> links) {
  if (links.size() != impl_->tree.places.size()) {
    throw Error("dynamic links: " + std::to_string(links.size()) + " flags; permitted are " +
                std::to_string(impl_->tree.places.size()) + ", one a link");
  }
  for (int i = 0; i < impl_->model.link_count(); ++i) {
    const JointKind kind = impl_->model.links()[static_cast<std::size_t>(i)].joint;
    const int body = impl_->tree.places[static_cast<std::size_t>(i)].body;
    if (kind != JointKind::kFixed)
      impl_->plan.dynamic[static_cast<std::size_t>(body)] = links[static_cast<std::size_t>(i)];
  }
  impl_->plan.rebuild(impl_->tree);
}

void FigureDynamics::set_all_dynamic(bool dynamic) {
  std::fill(impl_->plan.dynamic.begin(), impl_->plan.dynamic.end(), dynamic);
  impl_->plan.rebuild(impl_->tree);
}

bool FigureDynamics::dynamic(int link) const {
  check_index("link", link, impl_->model.link_count());
  if (impl_->model.links()[static_cast<std::size_t>(link)].joint == JointKind::kFixed) return false;
  return impl_->plan
      .dynamic[static_cast<std::size_t>(impl_->tree.places[static_cast<std::size_t>(link)].body)];
}

void FigureDynamics::set_method(ForwardMethod method) {
  if (method == this->method()) return;
  impl_->matrix = method == ForwardMethod::kMatrix ? std::make_unique<MatrixForward>(impl_->model) : nullptr;
}
ForwardMethod FigureDynamics::method() const {
  return impl_->matrix ? ForwardMethod::kMatrix : ForwardMethod::kArticulated;
}

void FigureDynamics::set_gravity(const Vec3& gravity) {
  check_range("gravity", gravity, -kMaxAcceleration, kMaxAcceleration);
  impl_->gravity = gravity;
}
const Vec3& FigureDynamics::gravity() const { return impl_->gravity; }

void FigureDynamics::set_base_acceleration(const Vec3& acceleration) {
  check_range("base_acceleration", acceleration, -kMaxAcceleration, kMaxAcceleration);
  impl_->base_acceleration = acceleration;
}
const Vec3& FigureDynamics::base_acceleration() const { return impl_->base_acceleration; }

void FigureDynamics::set_implicit_time(double time) {
  check_range("implicit time", time, 0, 1);
  impl_->implicit_time = time;
}

void FigureDynamics::forward(const double* q, const double* qd, const double* tau, double* qdd,
                             std::span<const Wrench> loads) {
  Impl& m = *impl_;
  ++m.counts.calls;
  if (m.matrix) {
    m.matrix->forward(*this, q, qd, tau, qdd, loads, m.implicit_time);
    return;
  }
  m.counts.placed += static_cast<long long>(m.plan.placed.size());
  m.counts.articulated += static_cast<long long>(m.plan.articulated.size());
  m.set_world();
  m.in_packs = m.limbs.usable() && m.plan.all_dynamic && loads.empty() && m.implicit_time == 0;
  if (m.in_packs) {
    m.limbs.forward(m.world.acceleration.move, q, qd, tau, qdd);
    return;
  }
  const ForwardWalk walk{m.tree.bodies.data(),
                         m.plan.placed.data(),
                         static_cast<int>(m.plan.placed.size()),
                         m.plan.articulated.data(),
                         static_cast<int>(m.plan.articulated.size()),
                         m.plan.dynamic.data(),
                         m.plan.bears.data(),
                         &m.world.acceleration,
                         m.implicit_time,
                         q,
                         qd,
                         tau,
                         m.torque.data(),
                         qdd,
                         m.work.data(),
                         m.balls.data()};
  m.walker.place(walk);
  m.bear(loads);
  m.walker.solve(walk);
}

void FigureDynamics::respond(std::span<const Wrench> loads, double* change) {
  Impl& m = *impl_;
  if (m.matrix) {
    m.matrix->respond(*this, loads, change);
    return;
  }
  m.unpack_limbs();
  for (V6<double>& wrench : m.reply) wrench = {{0, 0, 0}, {0, 0, 0}};
  for (const Wrench& load : loads) {
    int body = -1;
    const V6<double> wrench = m.at_joint(load, body);
    if (body >= 0) m.reply[static_cast<std::size_t>(body)] = m.reply[static_cast<std::size_t>(body)] - wrench;
  }
  m.respond(m.zero.data(), change);
}

void FigureDynamics::respond_to_torques(const double* tau, double* change) {
  Impl& m = *impl_;
  if (m.matrix) {
    m.matrix->respond_to_torques(tau, change);
    return;
  }
  m.unpack_limbs();
  for (V6<double>& wrench : m.reply) wrench = {{0, 0, 0}, {0, 0, 0}};
  m.respond(tau, change);
}

void FigureDynamics::Impl::respond(const double* tau, double* change) {
  Impl& m = *this;
  for (auto it = m.plan.articulated.rbegin(); it != m.plan.articulated.rend(); ++it) {
    const auto i = static_cast<std::size_t>(*it);
    const TreeBody& body = m.tree.bodies[i];
    if (body.parent < 0 || !m.plan.bears[static_cast<std::size_t>(body.parent)]) continue;
    const V6<double> on =
        m.plan.dynamic[i]
            ? passed_on(body, m.work[i], m.balls[static_cast<std::size_t>(body.ball)], tau, m.reply[i])
            : m.reply[i];
    V6<double>& parent = m.reply[static_cast<std::size_t>(body.parent)];
    parent.turn = parent.turn + on.turn + cross(m.work[i].arm, on.move);
    parent.move = parent.move + on.move;
  }
  // The slots of the wrenches take the accelerations, parents first.
  for (int k : m.plan.articulated) {
    const auto i = static_cast<std::size_t>(k);
    const TreeBody& body = m.tree.bodies[i];
    V6<double> a{{0, 0, 0}, {0, 0, 0}};
    if (body.parent >= 0 && m.plan.bears[static_cast<std::size_t>(body.parent)]) {
      a = m.reply[static_cast<std::size_t>(body.parent)];
      a.move = a.move + cross(a.turn, m.work[i].arm);
    }
    m.reply[i] = m.plan.dynamic[i] ? replied(body, m.work[i], m.balls[static_cast<std::size_t>(body.ball)],
                                             tau, m.reply[i], a, change)
                                   : a;
  }
}

void FigureDynamics::inverse(const double* q, const double* qd, const double* qdd, double* tau,
                             std::span<const Wrench> loads) {
  Impl& m = *impl_;
  m.unpack_limbs();
  m.set_world();
  for (std::size_t i = 0; i < m.tree.bodies.size(); ++i) {
    const TreeBody& body = m.tree.bodies[i];
    BodyWork<double>& work = m.work[i];
    place_body(body, m.parent_of(body), q, qd, work);
    weigh(body, work);
    work.acceleration = carried(m.acceleration_of(body.parent), work);
    accelerate(body, work, qdd, work.acceleration);
    work.bias = work.bias + work.inertia * work.acceleration;
  }
  m.bear(loads);
  for (std::size_t k = m.tree.bodies.size(); k-- > 0;) {
    const TreeBody& body = m.tree.bodies[k];
    const BodyWork<double>& work = m.work[k];
    take_torque(body, work, work.bias, tau);
    for (int j = body.v; j < body.v + velocity_count(body.joint); ++j) {
      tau[j] += body.armature * qdd[j] + body.damping * qd[j];
    }
    if (body.parent >= 0) {
      BodyWork<double>& parent = m.work[static_cast<std::size_t>(body.parent)];
      parent.bias.turn = parent.bias.turn + work.bias.turn + cross(work.arm, work.bias.move);
      parent.bias.move = parent.bias.move + work.bias.move;
    }
  }
}

void FigureDynamics::bias(const double* q, const double* qd, double* b, std::span<const Wrench> loads) {
  inverse(q, qd, impl_->zero.data(), b, loads);
}

void FigureDynamics::inertia_matrix(const double* q, double* h) {
  Impl& m = *impl_;
  const Vec3 gravity = m.gravity, base = m.base_acceleration;
  m.gravity = m.base_acceleration = Vec3::Zero();
  const int n = m.model.velocity_count();
  for (int i = 0; i < n; ++i) {
    m.unit[static_cast<std::size_t>(i)] = 1;
    inverse(q, m.zero.data(), m.unit.data(), h + static_cast<std::ptrdiff_t>(i) * n);
    m.unit[static_cast<std::size_t>(i)] = 0;
  }
  m.gravity = gravity;
  m.base_acceleration = base;
}

const FigureDynamics::Counts& FigureDynamics::counts() const { return impl_->counts; }

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
