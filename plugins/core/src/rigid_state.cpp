#include "rigid_state.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>

namespace softpoint::inline SOFTPOINT_ABI {

void RigidState::integrate(double dt) {
  if (body == nullptr) {
    return;
  }
  end.origin = start.origin + dt * velocity;
  end.rotation = bullet_turn(angular_velocity, dt) * start.rotation;
}

RigidStates::RigidStates(btDiscreteDynamicsWorld& world)
    : multibody_world_(dynamic_cast<btMultiBodyDynamicsWorld*>(&world)),
      forces_come_first_(dynamic_cast<btDeformableMultiBodyDynamicsWorld*>(&world) != nullptr) {}

void RigidStates::clear() {
  states_.clear();
  for (Articulated& articulated : articulated_) {
    articulated.in_use = false;
  }
}

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
  if (body != nullptr && !body->isStaticOrKinematicObject()) {
    state.velocity = from_bullet(body->getLinearVelocity());
    state.angular_velocity = from_bullet(body->getAngularVelocity());
    if (body->getInvMass() > 0) {
      state.body = body;
      state.inverse_mass = double(body->getInvMass()) * from_bullet(body->getLinearFactor());
      const Vec3 factor = from_bullet(body->getAngularFactor());
      state.inverse_inertia =
          factor.asDiagonal() * from_bullet(body->getInvInertiaTensorWorld()) * factor.asDiagonal();
    }
  } else if (!read_link(state, dt) && object->isKinematicObject()) {
    state.velocity =
        from_bullet(body != nullptr ? body->getLinearVelocity() : object->getInterpolationLinearVelocity());
    state.angular_velocity =
        from_bullet(body != nullptr ? body->getAngularVelocity() : object->getInterpolationAngularVelocity());
    // The application has already put it at its end pose; it came from where its velocities say.
    state.start.origin -= dt * state.velocity;
    state.start.rotation = bullet_turn(-state.angular_velocity, dt) * state.start.rotation;
  }
  if (state.articulated < 0) {
    state.free_velocity = state.velocity;
    state.free_angular_velocity = state.angular_velocity;
  }
  state.integrate(dt);
  states_.push_back(state);
  return size() - 1;
}

// Fills in a link of a multibody that this world steps; false for everything else.
bool RigidStates::read_link(RigidState& state, double dt) {
  const btMultiBodyLinkCollider* link = btMultiBodyLinkCollider::upcast(state.object);
  if (link == nullptr || link->m_multiBody == nullptr || multibody_world_ == nullptr) {
    return false;
  }
  state.articulated = find_or_add_articulated(*link->m_multiBody, dt);
  if (state.articulated < 0) {
    return false;
  }
  Articulated& articulated = articulated_[static_cast<std::size_t>(state.articulated)];
  const ArticulatedBody& body = articulated.body;
  state.slot = articulated.body.touch(link->m_link);
  state.movable_link = body.movable(state.slot);
  state.start = body.start(state.slot);
  state.end = body.end(state.slot, dt);
  const ArticulatedBody::Twist twist = body.twist(state.slot), free = body.free_twist(state.slot);
  state.velocity = twist.head<3>();
  state.angular_velocity = twist.tail<3>();
  state.free_velocity = free.head<3>();
  state.free_angular_velocity = free.tail<3>();
  articulated.states.push_back(size());
  return true;
}

// Index of the view of a multibody, or -1 when the world does not hold it.
int RigidStates::find_or_add_articulated(btMultiBody& body, double dt) {
  const int count = multibody_world_->getNumMultibodies();
  int index = 0;
  while (index < count && multibody_world_->getMultiBody(index) != &body) {
    ++index;
  }
  if (index == count) {
    return -1;
  }
  if (articulated_.size() < static_cast<std::size_t>(count)) {
    articulated_.resize(static_cast<std::size_t>(count));
  }
  Articulated& articulated = articulated_[static_cast<std::size_t>(index)];
  if (!articulated.in_use) {
    articulated.body.read(body, dt);
    articulated.states.clear();
    articulated.in_use = true;
    articulated.changed = false;
  }
  return index;
}

void RigidStates::push(int index, const Vec3& impulse, const Vec3& arm) {
  if (impulse != Vec3::Zero()) {
    push_wrench(index, impulse, arm.cross(impulse));
  }
}

void RigidStates::push_wrench(int index, const Vec3& impulse, const Vec3& moment) {
  RigidState& state = (*this)[index];
  if (!state.movable()) {
    return;
  }
  state.changed = true;
  if (state.body != nullptr) {
    state.velocity += state.inverse_mass.cwiseProduct(impulse);
    state.angular_velocity += state.inverse_inertia * moment;
    return;
  }
  Articulated& articulated = articulated_[static_cast<std::size_t>(state.articulated)];
  articulated.changed = true;
  ArticulatedBody::Twist wrench;
  wrench << impulse, moment;
  articulated.body.push(state.slot, wrench);
  for (std::size_t slot = 0; slot < articulated.states.size(); ++slot) {
    RigidState& other = (*this)[articulated.states[slot]];
    const ArticulatedBody::Twist change =
        articulated.body.response(static_cast<int>(slot), state.slot) * wrench;
    other.velocity += change.head<3>();
    other.angular_velocity += change.tail<3>();
  }
}

void RigidStates::push_free(int index, const Vec3& impulse, const Vec3& arm) {
  RigidState& state = (*this)[index];
  if (!state.movable()) {
    return;
  }
  if (state.body != nullptr) {
    state.free_velocity += state.inverse_mass.cwiseProduct(impulse);
    state.free_angular_velocity += state.inverse_inertia * arm.cross(impulse);
    push(index, impulse, arm);
    return;
  }
  Articulated& articulated = articulated_[static_cast<std::size_t>(state.articulated)];
  ArticulatedBody::Twist wrench;
  wrench << impulse, arm.cross(impulse);
  articulated.body.push_free(state.slot, wrench);
  push(index, impulse, arm);
  for (std::size_t slot = 0; slot < articulated.states.size(); ++slot) {
    RigidState& other = (*this)[articulated.states[slot]];
    const ArticulatedBody::Twist change =
        articulated.body.response(static_cast<int>(slot), state.slot) * wrench;
    other.free_velocity += change.head<3>();
    other.free_angular_velocity += change.tail<3>();
  }
}

Mat3 RigidStates::compliance(int a, const Vec3& arm_a, int b, const Vec3& arm_b) const {
  const RigidState& at_a = (*this)[a];
  const RigidState& at_b = (*this)[b];
  if (at_a.movable_link && at_b.movable_link && at_a.articulated == at_b.articulated) {
    const ArticulatedBody::Response& response =
        articulated_[static_cast<std::size_t>(at_a.articulated)].body.response(at_a.slot, at_b.slot);
    const Mat3 from_a = cross_matrix(arm_a), from_b = cross_matrix(arm_b);
    return response.block<3, 3>(0, 0) + response.block<3, 3>(0, 3) * from_b -
           from_a * (response.block<3, 3>(3, 0) + response.block<3, 3>(3, 3) * from_b);
  }
  if (a != b || at_a.body == nullptr) {
    return Mat3::Zero();
  }
  Mat3 result = -cross_matrix(arm_a) * at_a.inverse_inertia * cross_matrix(arm_b);
  result.diagonal() += at_a.inverse_mass;
  return result;
}

void RigidStates::mobility(int index, double* block) const {
  const RigidState& state = (*this)[index];
  Eigen::Map<Eigen::Matrix<double, 6, 6>> result(block);
  result.setZero();
  if (state.movable_link) {
    result = articulated_[static_cast<std::size_t>(state.articulated)].body.response(state.slot, state.slot);
  } else if (state.body != nullptr) {
    result.diagonal().head<3>() = state.inverse_mass;
    result.bottomRightCorner<3, 3>() = state.inverse_inertia;
  }
}

bool RigidStates::joined(int a, int b) const {
  const RigidState& at_a = (*this)[a];
  const RigidState& at_b = (*this)[b];
  return at_a.movable() && at_b.movable() &&
         (a == b || (at_a.movable_link && at_b.movable_link && at_a.articulated == at_b.articulated));
}

void RigidStates::restart() {
  for (RigidState& state : states_) {
    state.velocity = state.free_velocity;
    state.angular_velocity = state.free_angular_velocity;
  }
  for (Articulated& articulated : articulated_) {
    if (articulated.in_use) {
      articulated.body.restart();
    }
  }
}

void RigidStates::integrate(double dt) {
  for (RigidState& state : states_) {
    if (state.movable_link) {
      state.end = articulated_[static_cast<std::size_t>(state.articulated)].body.end(state.slot, dt);
    }
    state.integrate(dt);
  }
}

Vec3 RigidStates::end_point(int index, const Vec3& local, double dt) const {
  const RigidState& state = (*this)[index];
  if (state.movable_link) {
    return articulated_[static_cast<std::size_t>(state.articulated)].body.end(state.slot, dt).to_world(local);
  }
  if (state.body == nullptr) {
    return state.end.to_world(local);
  }
  return state.start.origin + dt * state.velocity +
         bullet_turn_quaternion(state.angular_velocity, dt) * (state.start.rotation * local);
}

void RigidStates::write_back() {
  write_back_rigid();
  for (Articulated& articulated : articulated_) {
    if (articulated.in_use && articulated.changed) {
      articulated.body.write_back();
    }
  }
}

void RigidStates::load(double dt, bool solved) {
  write_back_rigid();
  for (Articulated& articulated : articulated_) {
    if (articulated.in_use && articulated.changed) {
      articulated.body.load(!solved && !forces_come_first_, dt);
    }
  }
}

void RigidStates::take_back() {
  for (Articulated& articulated : articulated_) {
    articulated.body.take_back_forces();
  }
}

void RigidStates::write_back_rigid() {
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
