#include "world_touches.h"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <LinearMath/btTransformUtil.h>

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

bool closed_form(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
    case SPHERE_SHAPE_PROXYTYPE:
    case CAPSULE_SHAPE_PROXYTYPE:
    case STATIC_PLANE_PROXYTYPE:
      return true;
    case COMPOUND_SHAPE_PROXYTYPE: {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        if (!closed_form(*compound.getChildShape(i))) return false;
      }
      return true;
    }
    default:
      return false;
  }
}

// How fast any point of an object goes, m/s.
double speed_of(const btCollisionObject& object) {
  const btRigidBody* const body = btRigidBody::upcast(&object);
  if (body == nullptr || body->isStaticObject()) return 0;
  btVector3 center;
  btScalar radius = 0;
  body->getCollisionShape()->getBoundingSphere(center, radius);
  return static_cast<double>(body->getLinearVelocity().length() +
                             body->getAngularVelocity().length() * (radius + center.length()));
}

// Objects of a broad phase whose boxes meet one of a capsule that may touch them.
struct Finder final : btBroadphaseAabbCallback {
  const btBroadphaseProxy* own = nullptr;
  const std::vector<btRigidBody*>* left_out = nullptr;
  std::vector<const btCollisionObject*>* found = nullptr;
  bool process(const btBroadphaseProxy* proxy) override {
    const auto* const object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
    const bool meets = (proxy->m_collisionFilterGroup & own->m_collisionFilterMask) != 0 &&
                       (own->m_collisionFilterGroup & proxy->m_collisionFilterMask) != 0;
    if (!meets || !object->hasContactResponse() || !closed_form(*object->getCollisionShape())) return true;
    const auto* const shown = static_cast<const btCollisionObject*>(own->m_clientObject);
    if (!shown->checkCollideWith(object) || !object->checkCollideWith(shown)) return true;
    if (std::find(left_out->begin(), left_out->end(), object) == left_out->end()) found->push_back(object);
    return true;
  }
};

}  // namespace

int WorldTouches::index_of(btRigidBody* body, const btTransform& place, double left) {
  const auto it = std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& b) { return b.body == body; });
  if (it != bodies_.end()) return static_cast<int>(it - bodies_.begin());
  bodies_.push_back({body, place, left});
  return static_cast<int>(bodies_.size()) - 1;
}

void WorldTouches::gather(btCollisionWorld& world, const std::vector<btRigidBody*>& own, double dt) {
  found_.clear();
  found_gaps_.clear();
  found_bodies_.clear();
  near_.clear();
  Finder finder;
  finder.left_out = &own;
  finder.found = &candidates_;
  double fastest = 0;
  for (int i = 0; i < world.getNumCollisionObjects(); ++i) {
    fastest = std::max(fastest, speed_of(*world.getCollisionObjectArray()[i]));
  }
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const Capsule& c = capsules_[i];
    if (c.link < 0 || c.body->getBroadphaseHandle() == nullptr) continue;
    candidates_.clear();
    finder.own = c.body->getBroadphaseHandle();
    const Vec3 around = Vec3::Constant(c.radius + c.reach + std::min(1.5 * dt * fastest, 10.0));
    world.getBroadphase()->aabbTest(to_world(c.from.cwiseMin(c.to) - around),
                                    to_world(c.from.cwiseMax(c.to) + around), finder);
    std::sort(candidates_.begin(), candidates_.end(),
              [](const auto* a, const auto* b) { return a->getWorldArrayIndex() < b->getWorldArrayIndex(); });
    for (const btCollisionObject* object : candidates_) near_.push_back({i, object});
  }
  btDispatcher& dispatcher = *world.getDispatcher();
  const auto link_of = [&](const btCollisionObject* object) {
    for (const Capsule& c : capsules_) {
      if (c.body == object) return c.link;
    }
    return -1;
  };
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    const int first = link_of(manifold.getBody0()), second = link_of(manifold.getBody1());
    if ((first < 0) == (second < 0)) continue;
    const btCollisionObject* const object = first >= 0 ? manifold.getBody1() : manifold.getBody0();
    if (!object->hasContactResponse() || closed_form(*object->getCollisionShape())) continue;
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
      found_.push_back(contact);
      found_bodies_.push_back(body);
      found_gaps_.push_back(static_cast<double>(at.getDistance()));
    }
  }
}

void WorldTouches::keep(const Capsule& capsule, const SegmentDistance& d, double inside, double reach) {
  const double gap = d.distance - inside - capsule.radius;
  if (!(gap <= reach)) return;
  ContactImpulses::Contact contact;
  contact.link = capsule.link;
  contact.normal = d.normal;
  contact.point = capsule.from + d.at * (capsule.to - capsule.from) - capsule.radius * d.normal;
  contact.other = other_;
  contact.friction = friction_;
  contacts_.push_back(contact);
  gaps_.push_back(gap);
}

void WorldTouches::look_at(const Near& near, const btCollisionShape& shape, const btTransform& at,
                           double reach) {
  const Capsule& c = capsules_[near.capsule];
  const Vec3 origin = from_world(at.getOrigin());
  Mat3 axes;
  for (int k = 0; k < 3; ++k) axes.col(k) = from_world(at.getBasis().getColumn(k));
  const bool point = c.from == c.to;
  narrow_ += shape.getShapeType() != COMPOUND_SHAPE_PROXYTYPE;
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE: {
      const Vec3 half = from_world(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin());
      const Vec3 a = axes.transpose() * (c.from - origin), b = axes.transpose() * (c.to - origin);
      SegmentDistance nearest = segment_to_box(a, b, half);
      if (nearest.distance - c.radius > reach) return;
      const Vec3 normal = nearest.normal;
      nearest.normal = axes * normal;
      keep(c, nearest, 0, reach);
      for (const double end : {0.0, 1.0}) {  // what lies on a face is borne at both ends
        if (point || std::abs(end - nearest.at) < 1e-9) continue;
        const Vec3& tip = end == 0 ? a : b;
        SegmentDistance alone = segment_to_box(tip, tip, half);
        if (!(alone.normal.dot(normal) > 0.99)) continue;
        alone.normal = axes * alone.normal;
        alone.at = end;
        keep(c, alone, 0, reach);
      }
      return;
    }
    case SPHERE_SHAPE_PROXYTYPE:
      return keep(c, segment_to_segment(c.from, c.to, origin, origin),
                  static_cast<double>(static_cast<const btSphereShape&>(shape).getRadius()), reach);
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      const Vec3 arm = static_cast<double>(capsule.getHalfHeight()) * axes.col(capsule.getUpAxis());
      return keep(c, segment_to_segment(c.from, c.to, origin - arm, origin + arm),
                  static_cast<double>(capsule.getRadius()), reach);
    }
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      SegmentDistance d;
      d.normal = axes * from_world(plane.getPlaneNormal());
      const double level = d.normal.dot(origin) + static_cast<double>(plane.getPlaneConstant());
      for (const double end : {0.0, 1.0}) {
        d.at = end;
        d.distance = d.normal.dot(end == 0 ? c.from : c.to) - level;
        if (end == 0 || !point) keep(c, d, 0, reach);
      }
      return;
    }
    case COMPOUND_SHAPE_PROXYTYPE: {
      const auto& compound = static_cast<const btCompoundShape&>(shape);
      for (int i = 0; i < compound.getNumChildShapes(); ++i) {
        look_at(near, *compound.getChildShape(i), at * compound.getChildTransform(i), reach);
      }
      return;
    }
    default:
      return;
  }
}

void WorldTouches::look(double back, double ahead) {
  bodies_.clear();
  contacts_ = found_;
  gaps_ = found_gaps_;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (found_bodies_[i] == nullptr) continue;
    contacts_[i].other = index_of(found_bodies_[i], found_bodies_[i]->getWorldTransform(), 0);
  }
  for (const Near& near : near_) {
    const btCollisionObject& object = *near.object;
    btTransform at = object.getWorldTransform();
    btRigidBody* const body = const_cast<btRigidBody*>(btRigidBody::upcast(&object));
    if (body != nullptr && !body->isStaticObject() && back > 0) {
      btTransformUtil::integrateTransform(object.getWorldTransform(), body->getLinearVelocity(),
                                          body->getAngularVelocity(), static_cast<btScalar>(-back), at);
    }
    const Capsule& c = capsules_[near.capsule];
    const double reach = c.reach + 1.5 * ahead * speed_of(object);
    btVector3 low, high;
    object.getCollisionShape()->getAabb(at, low, high);
    const Vec3 around = Vec3::Constant(c.radius + reach);
    const bool apart = ((c.from.cwiseMin(c.to) - around).array() > from_world(high).array()).any() ||
                       ((c.from.cwiseMax(c.to) + around).array() < from_world(low).array()).any();
    if (apart) continue;
    ++overlapping_;
    other_ = -1;
    if (body != nullptr) other_ = index_of(body, at, back);
    friction_ = static_cast<double>(
        btManifoldResult::calculateCombinedFriction(capsules_[near.capsule].body, &object));
    look_at(near, *object.getCollisionShape(), at, reach);
  }
}

std::span<const ContactImpulses::Other> WorldTouches::others() {
  others_.resize(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const btRigidBody& body = *bodies_[i].body;
    ContactImpulses::Other& other = others_[i];
    other.center = from_world(bodies_[i].place.getOrigin());
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
    const Body& touched = bodies_[static_cast<std::size_t>(contacts_[i].other)];
    btRigidBody& body = *touched.body;
    if (body.isStaticOrKinematicObject()) continue;
    body.activate();
    const btVector3 velocity = body.getLinearVelocity(), spin = body.getAngularVelocity();
    body.applyImpulse(to_world(-impulses[i]), to_world(contacts_[i].point) - touched.place.getOrigin());
    if (!(touched.left > 0)) continue;
    btTransform moved;
    btTransformUtil::integrateTransform(body.getWorldTransform(), body.getLinearVelocity() - velocity,
                                        body.getAngularVelocity() - spin, static_cast<btScalar>(touched.left),
                                        moved);
    body.setWorldTransform(moved);
    body.setInterpolationWorldTransform(moved);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
