#include "rigid_state.h"

#include <algorithm>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI {

void RigidState::integrate(double dt) {
  if (body == nullptr) {
    return;
  }
  end.origin = start.origin + dt * velocity;
  // Bullet limits the turn of one step to a quarter of pi.
  double speed = angular_velocity.norm();
  const double limit = 0.25 * std::numbers::pi;
  const double angle = std::min(speed * dt, limit);
  end.rotation = angle > 0.0 ? Mat3(Eigen::AngleAxisd(angle, angular_velocity / speed) * start.rotation)
                             : start.rotation;
}

void RigidStates::clear() { states_.clear(); }

int RigidStates::find(const btCollisionObject* object) const {
  // A handful of colliders touch deformables at a time: a scan beats a map and never allocates.
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (states_[i].object == object) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

int RigidStates::find_or_add(const btCollisionObject* object, double dt) {
  if (const int known = find(object); known >= 0) {
    return known;
  }
  RigidState state;
  state.object = object;
  state.start = state.end = from_bullet(object->getWorldTransform());
  // The world hands collision objects out as const; contact impulses are what moves them.
  btRigidBody* body = const_cast<btRigidBody*>(btRigidBody::upcast(object));
  if (body != nullptr) {
    state.velocity = from_bullet(body->getLinearVelocity());
    state.angular_velocity = from_bullet(body->getAngularVelocity());
    if (body->isStaticObject()) {
      state.velocity.setZero();
      state.angular_velocity.setZero();
    } else if (body->isKinematicObject()) {
      // The application has already put it at its end pose; it came from where its velocity says.
      state.start.origin -= dt * state.velocity;
    } else if (body->getInvMass() > 0) {
      state.body = body;
      state.inverse_mass = double(body->getInvMass()) * from_bullet(body->getLinearFactor());
      const Vec3 factor = from_bullet(body->getAngularFactor());
      state.inverse_inertia =
          factor.asDiagonal() * from_bullet(body->getInvInertiaTensorWorld()) * factor.asDiagonal();
    }
  }
  state.free_velocity = state.velocity;
  state.free_angular_velocity = state.angular_velocity;
  state.integrate(dt);
  states_.push_back(state);
  return size() - 1;
}

void RigidStates::push(int index, const Vec3& impulse, const Vec3& arm) {
  RigidState& state = (*this)[index];
  if (state.body == nullptr || impulse == Vec3::Zero()) {
    return;
  }
  state.velocity += state.inverse_mass.cwiseProduct(impulse);
  state.angular_velocity += state.inverse_inertia * arm.cross(impulse);
  state.changed = true;
}

void RigidStates::push_free(int index, const Vec3& impulse, const Vec3& arm) {
  RigidState& state = (*this)[index];
  if (state.body == nullptr) {
    return;
  }
  state.free_velocity += state.inverse_mass.cwiseProduct(impulse);
  state.free_angular_velocity += state.inverse_inertia * arm.cross(impulse);
  push(index, impulse, arm);
}

Mat3 RigidStates::compliance(int a, const Vec3& arm_a, int b, const Vec3& arm_b) const {
  const RigidState& state = (*this)[a];
  if (a != b || state.body == nullptr) {
    return Mat3::Zero();
  }
  Mat3 result = -cross_matrix(arm_a) * state.inverse_inertia * cross_matrix(arm_b);
  result.diagonal() += state.inverse_mass;
  return result;
}

void RigidStates::restart() {
  for (RigidState& state : states_) {
    state.velocity = state.free_velocity;
    state.angular_velocity = state.free_angular_velocity;
  }
}

void RigidStates::integrate(double dt) {
  for (RigidState& state : states_) {
    state.integrate(dt);
  }
}

void RigidStates::write_back() {
  for (RigidState& state : states_) {
    if (state.body == nullptr || !state.changed) {
      continue;
    }
    if (!state.velocity.allFinite() || !state.angular_velocity.allFinite()) {
      continue;  // the guard: Bullet keeps what it had
    }
    state.body->setLinearVelocity(to_bullet(state.velocity));
    state.body->setAngularVelocity(to_bullet(state.angular_velocity));
    if (!state.body->isActive()) {
      state.body->activate(true);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
