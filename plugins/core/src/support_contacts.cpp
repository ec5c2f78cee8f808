#include "support_contacts.h"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// 1 / (relative velocity along `axis` per impulse pair along it).
double gain(const RigidStates& rigid, int a, int b, const Vec3& arm_a, const Vec3& arm_b, const Vec3& axis) {
  const Mat3 relative = rigid.compliance(a, arm_a, a, arm_a) + rigid.compliance(b, arm_b, b, arm_b) -
                        rigid.compliance(a, arm_a, b, arm_b) - rigid.compliance(b, arm_b, a, arm_a);
  const double k = axis.dot(relative * axis);
  return k > 0.0 ? 1.0 / k : 0.0;
}

}  // namespace

void SupportContacts::collect(btDispatcher& dispatcher, RigidStates& rigid, double dt) {
  rows_.clear();
  const int touched = rigid.size();
  const auto in_touched_island = [&](const btCollisionObject* object) {
    for (int i = 0; i < touched; ++i) {
      if (rigid[i].movable() && rigid[i].object->getIslandTag() == object->getIslandTag()) {
        return true;
      }
    }
    return false;
  };
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold* manifold = dispatcher.getManifoldByIndexInternal(m);
    const btCollisionObject* a = manifold->getBody0();
    const btCollisionObject* b = manifold->getBody1();
    if (manifold->getNumContacts() == 0 || !a->hasContactResponse() || !b->hasContactResponse()) {
      continue;
    }
    const bool a_moves = !a->isStaticOrKinematicObject(), b_moves = !b->isStaticOrKinematicObject();
    if (!(a_moves && in_touched_island(a)) && !(b_moves && in_touched_island(b))) {
      continue;
    }
    const int ia = rigid.find_or_add(a, dt), ib = rigid.find_or_add(b, dt);
    for (int i = 0; i < manifold->getNumContacts(); ++i) {
      add(manifold->getContactPoint(i), ia, ib, rigid, dt);
    }
  }
}

void SupportContacts::add(btManifoldPoint& point, int a, int b, const RigidStates& rigid, double dt) {
  Row row;
  row.point = &point;
  row.a = a;
  row.b = b;
  row.arm_a = from_bullet(point.getPositionWorldOnA()) - rigid[a].start.origin;
  row.arm_b = from_bullet(point.getPositionWorldOnB()) - rigid[b].start.origin;
  row.normal = from_bullet(point.m_normalWorldOnB).normalized();
  row.gain = gain(rigid, a, b, row.arm_a, row.arm_b, row.normal);
  if (row.gain == 0.0) {
    return;
  }
  Vec3 axis = Vec3::UnitX();
  if (std::abs(row.normal.x()) > 0.7) {
    axis = Vec3::UnitY();
  }
  row.tangents[0] = row.normal.cross(axis).normalized();
  row.tangents[1] = row.normal.cross(row.tangents[0]);
  const Vec3 settled = rigid[a].velocity_of(row.arm_a) - rigid[b].velocity_of(row.arm_b);
  row.impulse = point.m_appliedImpulse;
  row.friction = point.m_combinedFriction;
  // Approach is allowed until the gap closes. Where Bullet pushes things apart (restitution, position
  // correction) its speed stands; what it leaves approaching, after its few iterations, does not.
  const double speed = row.normal.dot(settled);
  const double closing = -std::max(double(point.getDistance()), 0.0) / dt;
  row.floor_speed = row.impulse > 0.0 ? std::max(speed, closing) : closing;
  const Vec3 lateral = double(point.m_appliedImpulseLateral1) * from_bullet(point.m_lateralFrictionDir1) +
                       double(point.m_appliedImpulseLateral2) * from_bullet(point.m_lateralFrictionDir2);
  for (std::size_t t = 0; t < 2; ++t) {
    row.tangent_gain[t] = gain(rigid, a, b, row.arm_a, row.arm_b, row.tangents[t]);
    row.friction_impulse[t] = row.tangents[t].dot(lateral);
  }
  row.bullet_impulse = row.impulse;
  row.bullet_friction = row.friction_impulse;
  rows_.push_back(row);
}

void SupportContacts::reapply(RigidStates& rigid) const {
  for (const Row& row : rows_) {
    Vec3 change = (row.impulse - row.bullet_impulse) * row.normal;
    for (std::size_t t = 0; t < 2; ++t) {
      change += (row.friction_impulse[t] - row.bullet_friction[t]) * row.tangents[t];
    }
    rigid.push(row.a, change, row.arm_a);
    rigid.push(row.b, -change, row.arm_b);
  }
}

double SupportContacts::sweep(RigidStates& rigid, double dt) {
  double largest = 0.0;
  for (Row& row : rows_) {
    const auto apply = [&](const Vec3& axis, double change) {
      if (change != 0.0) {
        rigid.push(row.a, change * axis, row.arm_a);
        rigid.push(row.b, -change * axis, row.arm_b);
      }
    };
    const auto speed = [&](const Vec3& axis) {
      return axis.dot(rigid[row.a].velocity_of(row.arm_a) - rigid[row.b].velocity_of(row.arm_b));
    };
    const double wanted = row.impulse + (row.floor_speed - speed(row.normal)) * row.gain;
    const double change = std::max(wanted, 0.0) - row.impulse;
    row.impulse += change;
    apply(row.normal, change);
    largest = std::max(largest, std::abs(change) / row.gain * dt);
    const double limit = row.friction * row.impulse;
    for (std::size_t t = 0; t < 2; ++t) {
      const double aim = row.friction_impulse[t] - speed(row.tangents[t]) * row.tangent_gain[t];
      const double friction_change = std::clamp(aim, -limit, limit) - row.friction_impulse[t];
      row.friction_impulse[t] += friction_change;
      apply(row.tangents[t], friction_change);
      largest = std::max(largest, std::abs(friction_change) / row.tangent_gain[t] * dt);
    }
  }
  return largest;
}

void SupportContacts::write_back() {
  for (Row& row : rows_) {
    row.point->m_appliedImpulse = btScalar(row.impulse);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
