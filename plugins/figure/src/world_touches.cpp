#include "world_touches.h"

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

Vec3 from_world(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

btVector3 to_world(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

}  // namespace

int WorldTouches::index_of(btRigidBody* body) {
  const auto it = std::find(bodies_.begin(), bodies_.end(), body);
  if (it == bodies_.end()) bodies_.push_back(body);
  return static_cast<int>(std::find(bodies_.begin(), bodies_.end(), body) - bodies_.begin());
}

void WorldTouches::gather(btCollisionWorld& world, const std::vector<btRigidBody*>& bodies,
                          const std::vector<int>& links) {
  contacts_.clear();
  gaps_.clear();
  bodies_.clear();
  btDispatcher& dispatcher = *world.getDispatcher();
  const auto link_of = [&](const btCollisionObject* object) {
    const auto it = std::find(bodies.begin(), bodies.end(), object);
    return it == bodies.end() ? -1 : links[static_cast<std::size_t>(it - bodies.begin())];
  };
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    const int first = link_of(manifold.getBody0()), second = link_of(manifold.getBody1());
    if ((first < 0) == (second < 0)) continue;
    const btCollisionObject* const object = first >= 0 ? manifold.getBody1() : manifold.getBody0();
    if (!object->hasContactResponse()) continue;
    btRigidBody* const body = const_cast<btRigidBody*>(btRigidBody::upcast(object));
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& at = manifold.getContactPoint(k);
      ContactImpulses::Contact contact;
      contact.link = std::max(first, second);
      contact.point = from_world(first >= 0 ? at.getPositionWorldOnA() : at.getPositionWorldOnB());
      contact.normal = (first >= 0 ? 1 : -1) * from_world(at.m_normalWorldOnB).normalized();
      const bool sound =
          contact.normal.norm() > 0.5 && contact.point.allFinite();  // Bullet's may be degenerate
      if (!sound || !std::isfinite(static_cast<double>(at.getDistance()))) continue;
      contact.friction = static_cast<double>(at.m_combinedFriction);
      if (body != nullptr) contact.other = index_of(body);
      contacts_.push_back(contact);
      gaps_.push_back(static_cast<double>(at.getDistance()));
    }
  }
}

std::span<const ContactImpulses::Other> WorldTouches::others() {
  others_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const btRigidBody& body = *bodies_[i];
    ContactImpulses::Other& other = others_[i];
    other.center = from_world(body.getCenterOfMassPosition());
    other.velocity = from_world(body.getLinearVelocity());
    other.spin = from_world(body.getAngularVelocity());
    const bool fixed = body.isStaticOrKinematicObject();
    other.inverse_mass = fixed ? 0 : static_cast<double>(body.getInvMass());
    other.inverse_inertia.setZero();
    if (fixed) continue;
    const btMatrix3x3& inverse = body.getInvInertiaTensorWorld();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) other.inverse_inertia(r, c) = static_cast<double>(inverse[r][c]);
    }
  }
  return others_;
}

void WorldTouches::push_back(const std::vector<Vec3>& impulses) {
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (contacts_[i].other < 0 || impulses[i].squaredNorm() == 0) continue;
    btRigidBody& body = *bodies_[static_cast<std::size_t>(contacts_[i].other)];
    if (body.isStaticOrKinematicObject()) continue;
    body.activate();
    body.applyImpulse(to_world(-impulses[i]), to_world(contacts_[i].point) - body.getCenterOfMassPosition());
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
