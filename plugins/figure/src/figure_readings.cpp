#include <Eigen/Geometry>

#include "figure_dynamics_impl.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

void FigureDynamics::place(const double* q, const double* qd) {
  Impl& m = *impl_;
  m.unpack_limbs();
  for (std::size_t i = 0; i < m.tree.bodies.size(); ++i) {
    const TreeBody& body = m.tree.bodies[i];
    BodyWork<double>& work = m.work[i];
    place_body(body, m.parent_of(body), q, qd, work);
    V3<double> position{0, 0, 0}, velocity{0, 0, 0};
    if (body.parent >= 0) {
      const auto parent = static_cast<std::size_t>(body.parent);
      position = m.positions[parent];
      velocity = m.velocities[parent] + cross(m.work[parent].spin, work.arm);
    }
    if (body.joint == JointKind::kPrismatic) velocity = velocity + work.axes.z * qd[body.v];
    if (body.joint == JointKind::kFree) {
      velocity = velocity + V3<double>{qd[body.v + 3], qd[body.v + 4], qd[body.v + 5]};
    }
    m.squared_rates[i] = 0;
    if (body.joint != JointKind::kFree) {  // it has no armature
      for (int k = body.v; k < body.v + velocity_count(body.joint); ++k) m.squared_rates[i] += qd[k] * qd[k];
    }
    m.positions[i] = position + work.arm;
    m.velocities[i] = velocity;
  }
}

LinkMotion FigureDynamics::motion(int link) const {
  check_index("link", link, impl_->model.link_count());
  const LinkPlace& place = impl_->tree.places[static_cast<std::size_t>(link)];
  LinkMotion motion;
  if (place.body < 0) {
    motion.position = vector(place.origin);
    motion.orientation = matrix(place.turn);
    return motion;
  }
  const auto body = static_cast<std::size_t>(place.body);
  const BodyWork<double>& work = impl_->work[body];
  const V3<double> arm = work.axes * place.origin;
  motion.position = vector(impl_->positions[body] + arm);
  motion.orientation = matrix(work.axes * place.turn);
  motion.angular_velocity = vector(work.spin);
  motion.velocity = vector(impl_->velocities[body] + cross(work.spin, arm));
  return motion;
}

FigureMechanics FigureDynamics::mechanics() const {
  FigureMechanics sum;
  double mass = 0;
  Vec3 moment = Vec3::Zero();
  for (std::size_t i = 0; i < impl_->tree.bodies.size(); ++i) {
    const TreeBody& body = impl_->tree.bodies[i];
    const BodyWork<double>& work = impl_->work[i];
    const Vec3 spin = vector(work.spin), velocity = vector(impl_->velocities[i]),
               at = vector(impl_->positions[i]);
    const Vec3 first = vector(work.axes * body.first_moment);
    const Vec3 turn = matrix(rotated(work.axes, body.inertia)) * spin;  // about the joint
    const Vec3 momentum = body.mass * velocity + spin.cross(first);
    const Vec3 angular = turn + first.cross(velocity);
    sum.kinetic_energy += 0.5 * (momentum.dot(velocity) + angular.dot(spin));
    sum.kinetic_energy += 0.5 * body.armature * impl_->squared_rates[i];
    sum.momentum += momentum;
    sum.angular_momentum += angular + at.cross(momentum);
    moment += body.mass * at + first;
    mass += body.mass;
  }
  if (mass > 0) sum.center_of_mass = moment / mass;
  sum.potential_energy = -impl_->gravity.dot(moment);
  return sum;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
