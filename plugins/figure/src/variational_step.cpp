#include "variational_step.h"

#include <algorithm>
#include <cmath>

#include "lane_convert.h"
#include "response-inl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// Turn vector of r0^T r1, in the axes of either.
V3<double> turn_between(const M3<double>& r0, const M3<double>& r1) {
  const V3<double> x = transposed_times(r0, r1.x), y = transposed_times(r0, r1.y),
                   z = transposed_times(r0, r1.z);
  const V3<double> v{0.5 * (y.z - z.y), 0.5 * (z.x - x.z), 0.5 * (x.y - y.x)};
  const double s = std::sqrt(dot(v, v)), c = 0.5 * (x.x + y.y + z.z - 1);
  if (s < 1e-4 && c > 0) return v * (1 + s * s / 6 + 3 * s * s * s * s / 40);
  return v * (std::atan2(s, c) / s);
}

// The transposed inverse of the exponential's derivative: what a momentum is at the turn's beginning.
V3<double> begun(const V3<double>& f, const V3<double>& m) {
  const double square = dot(f, f);
  double factor = 1.0 / 12 + square * (1.0 / 720 + square * (1.0 / 30240 + square / 1209600));
  if (square > 1e-2) {
    const double half = 0.5 * std::sqrt(square);
    factor = (1 - half / std::tan(half)) / square;
  }
  const V3<double> once = cross(f, m);
  return m + once * 0.5 + cross(f, once) * factor;
}

}  // namespace

VariationalStep::VariationalStep(const FigureModel& model) : tree_(build_tree(model)) {
  const std::size_t bodies = tree_.bodies.size();
  const auto n = static_cast<std::size_t>(std::max(model.velocity_count(), 1));
  begin_.resize(bodies);
  end_.resize(bodies);
  moved_.resize(bodies);
  momentum_.resize(bodies);
  carried_.resize(bodies);
  for (std::vector<double>* v : {&p_, &own_, &still_, &first_}) v->assign(n, 0.0);
  for (const TreeBody& body : tree_.bodies) {
    Weight weight{{0, 0, 0}, body.inertia};
    if (!body.massless) {
      const V3<double>& s = body.first_moment;
      weight.center = s * (1 / body.mass);
      const V3<double>& c = weight.center;
      weight.inertia.xx -= s.y * c.y + s.z * c.z;
      weight.inertia.yy -= s.z * c.z + s.x * c.x;
      weight.inertia.zz -= s.x * c.x + s.y * c.y;
      weight.inertia.xy += s.x * c.y;
      weight.inertia.xz += s.x * c.z;
      weight.inertia.yz += s.y * c.z;
    }
    weights_.push_back(weight);
  }
}

void VariationalStep::place(const double* q, const double* qd, std::vector<BodyWork<double>>& at) {
  for (std::size_t i = 0; i < tree_.bodies.size(); ++i) {
    const TreeBody& body = tree_.bodies[i];
    place_body(body, body.parent < 0 ? nullptr : &at[static_cast<std::size_t>(body.parent)], q, qd, at[i]);
  }
}

// What the joints have of the momenta with `half_step` times gravity added.
void VariationalStep::project(const std::vector<BodyWork<double>>& at, double half_step, double* p) {
  for (std::size_t i = 0; i < tree_.bodies.size(); ++i) {
    const TreeBody& body = tree_.bodies[i];
    const V3<double> force = momentum_[i].move + gravity_ * (half_step * body.mass);
    carried_[i] = {momentum_[i].turn + cross(at[i].axes * weights_[i].center, force), force};
  }
  for (std::size_t i = tree_.bodies.size(); i-- > 0;) {
    const TreeBody& body = tree_.bodies[i];
    take_torque(body, at[i], carried_[i], p);
    if (body.parent < 0) continue;
    V6<double>& parent = carried_[static_cast<std::size_t>(body.parent)];
    parent.turn = parent.turn + carried_[i].turn + cross(at[i].arm, carried_[i].move);
    parent.move = parent.move + carried_[i].move;
  }
}

void VariationalStep::begin(const double* q, const double* qd, const Vec3& gravity) {
  gravity_ = lanes(gravity);
  place(q, qd, begin_);
  for (std::size_t i = 0; i < tree_.bodies.size(); ++i) {
    const TreeBody& body = tree_.bodies[i];
    const BodyWork<double>& work = begin_[i];
    V3<double>& velocity = moved_[i];  // of the joint, for this once
    velocity = {0, 0, 0};
    if (body.parent >= 0) {
      const auto parent = static_cast<std::size_t>(body.parent);
      velocity = moved_[parent] + cross(begin_[parent].spin, work.arm);
    }
    if (body.joint == JointKind::kPrismatic) velocity = velocity + work.axes.z * qd[body.v];
    if (body.joint == JointKind::kFree) {
      velocity = velocity + V3<double>{qd[body.v + 3], qd[body.v + 4], qd[body.v + 5]};
    }
    const V3<double> spin = transposed_times(work.axes, work.spin);
    momentum_[i] = {work.axes * (weights_[i].inertia * spin),
                    (velocity + cross(work.spin, work.axes * weights_[i].center)) * body.mass};
  }
  project(begin_, 0, p_.data());
  for (const TreeBody& body : tree_.bodies) {
    for (int k = body.v; k < body.v + velocity_count(body.joint); ++k) {
      p_[static_cast<std::size_t>(k)] += body.armature * qd[k];
    }
  }
}

void VariationalStep::end(const double* q, const double* d, double h) {
  h_ = h;
  place(q, still_.data(), end_);
  for (std::size_t i = 0; i < tree_.bodies.size(); ++i) {
    const TreeBody& body = tree_.bodies[i];
    // Differences of arms, not of positions: digits far from the origin.
    moved_[i] = body.parent < 0 ? V3<double>{0, 0, 0} : moved_[static_cast<std::size_t>(body.parent)];
    moved_[i] = body.joint == JointKind::kFree
                    ? moved_[i] + V3<double>{d[body.v + 3], d[body.v + 4], d[body.v + 5]}
                    : moved_[i] + (end_[i].arm - begin_[i].arm);
    for (int k = body.v; k < body.v + velocity_count(body.joint); ++k) {
      own_[static_cast<std::size_t>(k)] = (body.armature / h - 0.5 * body.damping) * d[k];
      first_[static_cast<std::size_t>(k)] = (body.armature / h + 0.5 * body.damping) * d[k];
    }
    if (body.massless) {
      momentum_[i] = {{0, 0, 0}, {0, 0, 0}};
      continue;
    }
    const V3<double> turn = turn_between(begin_[i].axes, end_[i].axes);
    const V3<double> center =
        moved_[i] + (end_[i].axes * weights_[i].center - begin_[i].axes * weights_[i].center);
    momentum_[i] = {begin_[i].axes * begun(turn, weights_[i].inertia * turn * (1 / h)),
                    center * (body.mass / h)};
  }
}

void VariationalStep::residual(double* r) {
  project(begin_, -0.5 * h_, r);
  for (std::size_t k = 0; k < p_.size(); ++k) r[k] = p_[k] - r[k] - first_[k];
}

// (19) as (18) plus a difference: roundings over a short step would grow in the quotients.
void VariationalStep::momenta(double* p) {
  project(begin_, -0.5 * h_, still_.data());
  project(end_, 0.5 * h_, p);
  for (std::size_t k = 0; k < p_.size(); ++k) {
    p[k] = p_[k] + ((p[k] - still_[k]) + (own_[k] - first_[k]));
    still_[k] = 0;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
