// The part of a snapshot that is Bullet's: motion and sleep of what is in the world, and its caches.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>

#include "bullet_archive.h"
#include "deformable_system_impl.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Time that stepSimulation has taken in but not yet stepped; a protected member.
struct LeftOver : btDiscreteDynamicsWorld {
  static btScalar& of(btDiscreteDynamicsWorld& world) { return world.*(&LeftOver::m_localTime); }
};

void archive_object_state(StateArchive& archive, btCollisionObject& object) {
  int activation = object.getActivationState(), island = object.getIslandTag();
  btScalar resting = object.getDeactivationTime();
  btTransform pose = object.getWorldTransform(), ahead = object.getInterpolationWorldTransform();
  btVector3 linear = object.getInterpolationLinearVelocity(),
            angular = object.getInterpolationAngularVelocity();
  archive.constant("internal type", static_cast<std::uint64_t>(object.getInternalType()));
  archive.integer("activation state", activation, 0, FIXED_BASE_MULTI_BODY);
  archive.integer("island", island, -2, 2147483647);
  archive_bullet(archive, "deactivation time", resting);
  archive_bullet(archive, "pose", pose);
  archive_bullet(archive, "interpolation pose", ahead);
  archive_bullet(archive, "interpolation velocity", linear);
  archive_bullet(archive, "interpolation spin", angular);
  if (!archive.loading()) {
    return;
  }
  object.forceActivationState(activation);
  object.setIslandTag(island);
  object.setDeactivationTime(resting);
  object.setWorldTransform(pose);
  object.setInterpolationWorldTransform(ahead);
  object.setInterpolationLinearVelocity(linear);
  object.setInterpolationAngularVelocity(angular);
}

void archive_rigid_body(StateArchive& archive, btRigidBody& body) {
  archive.constant("inverse mass", static_cast<double>(body.getInvMass()));
  btVector3 velocity = body.getLinearVelocity(), spin = body.getAngularVelocity();
  btVector3 force = body.getTotalForce(), torque = body.getTotalTorque();
  archive_bullet(archive, "velocity", velocity);
  archive_bullet(archive, "spin", spin);
  archive_bullet(archive, "force", force);
  archive_bullet(archive, "torque", torque);
  if (!archive.loading()) {
    return;
  }
  body.setLinearVelocity(velocity);
  body.setAngularVelocity(spin);
  body.clearForces();
  body.applyCentralForce(force);
  body.applyTorque(torque);
  body.updateInertiaTensor();
  if (body.getMotionState() != nullptr && !body.isStaticOrKinematicObject()) {
    body.getMotionState()->setWorldTransform(body.getWorldTransform());
  }
}

void archive_multibody(StateArchive& archive, btMultiBody& body) {
  archive.constant("number of links", static_cast<std::uint64_t>(body.getNumLinks()));
  btVector3 base = body.getBasePos(), velocity = body.getBaseVel(), spin = body.getBaseOmega();
  btQuaternion turn = body.getWorldToBaseRot();
  bool awake = body.isAwake();
  archive_bullet(archive, "base position", base);
  archive_bullet(archive, "base rotation", turn);
  archive_bullet(archive, "base velocity", velocity);
  archive_bullet(archive, "base spin", spin);
  archive.flag("awake", awake);
  if (archive.loading()) {
    body.setBasePos(base);
    body.setWorldToBaseRot(turn);
    body.setBaseVel(velocity);
    body.setBaseOmega(spin);
    awake ? body.wakeUp() : body.goToSleep();
  }
  for (int link = 0; link < body.getNumLinks(); ++link) {
    const btMultibodyLink& joint = body.getLink(link);
    archive.constant("degrees of freedom", static_cast<std::uint64_t>(joint.m_dofCount));
    btScalar position[7] = {}, rate[6] = {};
    std::copy_n(body.getJointPosMultiDof(link), joint.m_posVarCount, position);
    std::copy_n(body.getJointVelMultiDof(link), joint.m_dofCount, rate);
    for (int k = 0; k < joint.m_posVarCount; ++k) {
      archive_bullet(archive, "joint position", position[k]);
    }
    for (int k = 0; k < joint.m_dofCount; ++k) {
      archive_bullet(archive, "joint velocity", rate[k]);
    }
    if (archive.loading()) {
      body.setJointPosMultiDof(link, position);
      body.setJointVelMultiDof(link, rate);
    }
  }
  if (archive.loading()) {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    body.forwardKinematics(rotations, origins);
    body.updateCollisionObjectWorldTransforms(rotations, origins);
  }
}

}  // namespace

void DeformableSystem::Impl::archive_world(StateArchive& archive) {
  archive.begin("world");
  archive_bullet(archive, "time not yet stepped", LeftOver::of(world));
  if (auto* multibodies = dynamic_cast<btMultiBodyDynamicsWorld*>(&world)) {
    archive.constant("number of multibodies", static_cast<std::uint64_t>(multibodies->getNumMultibodies()));
    for (int i = 0; i < multibodies->getNumMultibodies(); ++i) {
      archive.begin("multibody", i);
      archive_multibody(archive, *multibodies->getMultiBody(i));
    }
  }
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    archive.begin("collision object", i);
    const bool ours = owns(objects[i]);
    archive.constant("one of the deformables", static_cast<std::uint64_t>(ours));
    if (ours) {
      continue;
    }
    archive_object_state(archive, *objects[i]);
    if (btRigidBody* body = btRigidBody::upcast(objects[i])) {
      archive_rigid_body(archive, *body);
    }
  }
}

// Every object enters the broadphase anew, in their order in the world: what Bullet finds, and in which
// order, then depends on the present alone.
void DeformableSystem::Impl::flush_contact_caches() {
  flushing_ = true;
  btBroadphaseInterface& broadphase = *world.getBroadphase();
  btDispatcher* dispatcher = world.getDispatcher();
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  struct Filter {
    int group, mask;
    bool inside;
  };
  std::vector<Filter> filters;
  for (int i = 0; i < objects.size(); ++i) {
    btBroadphaseProxy* proxy = objects[i]->getBroadphaseHandle();
    filters.push_back({0, 0, proxy != nullptr});
    if (proxy != nullptr) {
      filters.back() = {proxy->m_collisionFilterGroup, proxy->m_collisionFilterMask, true};
      broadphase.getOverlappingPairCache()->cleanProxyFromPairs(proxy, dispatcher);
      broadphase.destroyProxy(proxy, dispatcher);
      objects[i]->setBroadphaseHandle(nullptr);
    }
  }
  broadphase.resetPool(dispatcher);
  for (int i = 0; i < objects.size(); ++i) {
    const Filter& filter = filters[static_cast<std::size_t>(i)];
    if (filter.inside) {
      btVector3 low, high;
      objects[i]->getCollisionShape()->getAabb(objects[i]->getWorldTransform(), low, high);
      objects[i]->setBroadphaseHandle(
          broadphase.createProxy(low, high, objects[i]->getCollisionShape()->getShapeType(), objects[i],
                                 filter.group, filter.mask, dispatcher));
    }
  }
  world.getConstraintSolver()->reset();
  flushing_ = false;
  restored_ = true;
  // What is kept of shapes and skins depends on where bodies have been.
  pairs_.clear();
  patches_.clear();
  finders_.clear();
  const auto forget_number = [](Contact& contact) {
    const btCollisionShape* shape = contact.object->getCollisionShape();
    if ((shape->isConcave() || shape->isCompound()) && !shape->isSoftBody() &&
        (contact.kind == ContactKind::corner || contact.kind == ContactKind::edge) &&
        contact.rigid_feature >= 0) {
      contact.rigid_feature = -2 - contact.rigid_feature;
    }
  };
  for (Contact& contact : contacts_.all()) {
    forget_number(contact);
  }
  for (RestingContact& resting : resting_contacts_) {
    forget_number(resting.contact);
  }
  contacts_.reindex();
}

// Pairs of sleeping objects are not dispatched, and it is their algorithms that tell when they part.
void DeformableSystem::Impl::watch_pairs() {
  btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    auto* a = static_cast<btCollisionObject*>(pairs[i].m_pProxy0->m_clientObject);
    auto* b = static_cast<btCollisionObject*>(pairs[i].m_pProxy1->m_clientObject);
    if (pairs[i].m_algorithm == nullptr && (owns(a) || owns(b)) && a->checkCollideWith(b) &&
        b->checkCollideWith(a)) {
      const btCollisionObjectWrapper first(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1,
                                           -1);
      const btCollisionObjectWrapper second(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1,
                                            -1);
      pairs[i].m_algorithm =
          world.getDispatcher()->findAlgorithm(&first, &second, nullptr, BT_CONTACT_POINT_ALGORITHMS);
    }
  }
}

// Whether the bounds of the two do not overlap.
bool DeformableSystem::Impl::apart(const btCollisionObject* body, const btCollisionObject* object) const {
  const btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    const void* a = pairs[i].m_pProxy0->m_clientObject;
    const void* b = pairs[i].m_pProxy1->m_clientObject;
    if ((a == body && b == object) || (a == object && b == body)) {
      return false;
    }
  }
  return true;
}

// After a restoration: contacts whose objects are no longer near go, and their bodies wake.
void DeformableSystem::Impl::drop_unpaired() {
  watch_pairs();
  const auto gone = [&](const auto& contact) {
    return apart(bodies[static_cast<std::size_t>(contact.body)], contact.object);
  };
  for (const OwnLoad& load : own_loads_) {
    if (gone(load)) {
      bodies[static_cast<std::size_t>(load.body)]->activate(true);
    }
  }
  std::erase_if(own_loads_, gone);
  contacts_.erase_if(gone);
  for (const RestingContact& resting : resting_contacts_) {
    if (gone(resting.contact)) {
      bodies[static_cast<std::size_t>(resting.contact.body)]->activate(true);
    }
  }
  std::erase_if(resting_contacts_, [&](const RestingContact& resting) { return gone(resting.contact); });
  std::erase_if(surroundings_, [&](const Surrounding& near) {
    const bool tied = std::any_of(resting_handles_.begin(), resting_handles_.end(), [&](const Handle& held) {
      return held.object == near.object && bodies[static_cast<std::size_t>(held.body)] == near.body;
    });
    return !tied && apart(near.body, near.object);
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI
