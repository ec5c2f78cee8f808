// Waking: who is woken by what, and with what it goes on.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>

#include "deformable_system_impl.h"
#include "rest.h"

namespace softpoint::inline SOFTPOINT_ABI {

bool DeformableSystem::Impl::surroundings_moved(const Deformable& body) const {
  return tied_to_awake(body) ||
         std::any_of(surroundings_.begin(), surroundings_.end(), [&](const Surrounding& near) {
           return near.body == &body &&
                  (!(near.object->getWorldTransform() == near.pose) || moves(*near.object));
         });
}

// Bullet reports a pair of a sleeping body: is that a reason to wake it?
void DeformableSystem::Impl::wake_by_meeting(int index, const btCollisionObject& other, double dt) {
  Deformable& body = *bodies[static_cast<std::size_t>(index)];
  if (!body.asleep_ || frozen(body) || !other.hasContactResponse()) {
    return;
  }
  const bool new_surrounding =
      std::none_of(surroundings_.begin(), surroundings_.end(),
                   [&](const Surrounding& near) { return near.body == &body && near.object == &other; });
  // A movable object awake: Bullet is about to wake the island.
  if (other.isStaticOrKinematicObject() ? new_surrounding : other.isActive()) {
    rouse(body, dt);
  }
}

void DeformableSystem::Impl::lose_surrounding(const btCollisionObject* deformable,
                                              const btCollisionObject* other) {
  std::erase_if(surroundings_,
                [&](const Surrounding& near) { return near.body == deformable && near.object == other; });
  const auto lost = [&](const RestingContact& resting) {
    const btCollisionObject* body = bodies[static_cast<std::size_t>(resting.contact.body)];
    return (resting.contact.object == other && body == deformable) ||
           (resting.contact.object == deformable && body == other);
  };
  const bool own_lost =
      static_cast<const Deformable*>(deformable)->asleep() &&
      std::any_of(own_loads_.begin(), own_loads_.end(), [&](const OwnLoad& load) {
        return load.object == other && bodies[static_cast<std::size_t>(load.body)] == deformable;
      });
  if (std::erase_if(resting_contacts_, lost) > 0 || own_lost) {
    const_cast<btCollisionObject*>(deformable)->activate(true);
    wake_mates(*static_cast<const Deformable*>(deformable));
  }
}

// The islands of a body and of what it is tied to.
void DeformableSystem::Impl::collect_islands(const Deformable& body) {
  islands_.assign(1, body.getIslandTag());
  for (std::vector<Handle>* list : {&handles, &resting_handles_}) {
    for (Handle& held : *list) {
      if (bodies[static_cast<std::size_t>(held.body)] == &body && held.anchored() &&
          in_world(held.object, held.object_index)) {
        islands_.push_back(held.object->getIslandTag());
      }
    }
  }
}

bool DeformableSystem::Impl::in_islands(const btCollisionObject& object) const {
  return object.getIslandTag() >= 0 &&
         std::find(islands_.begin(), islands_.end(), object.getIslandTag()) != islands_.end();
}

// Between two steps: Bullet gives gravity to what is awake when a step begins.
void DeformableSystem::Impl::wake_mates(const Deformable& body) {
  if (frozen(body)) {
    return;
  }
  collect_islands(body);
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    btCollisionObject& mate = *objects[i];
    if (&mate == &body || !in_islands(mate)) {
      continue;
    }
    mate.activate(true);
    if (auto* link = btMultiBodyLinkCollider::upcast(&mate)) {
      link->m_multiBody->wakeUp();
    }
  }
}

void DeformableSystem::Impl::wake_the_roused(double dt) {
  const bool gravity_changed = !(known_gravity_ == world.getGravity());
  known_gravity_ = world.getGravity();
  profile.counts.deformables = static_cast<int>(bodies.size());
  profile.counts.sleeping = 0;
  for (Deformable* body : bodies) {
    if (!body->asleep_) {
      continue;
    }
    if (body->isActive() || (!frozen(*body) && (gravity_changed || surroundings_moved(*body)))) {
      rouse(*body, dt);
    }
  }
  for (const Deformable* body : bodies) {
    profile.counts.sleeping += body->asleep_;
  }
}

// Within a step: everything that sleeps with `body` wakes with it and is given at once what it needs to go on
// resting, gravity and the load of the last step.
void DeformableSystem::Impl::rouse(Deformable& body, double dt) {
  rouse_mates(body, dt);
  for (Deformable* mate : bodies) {
    if (mate == &body || (mate->asleep_ && !frozen(*mate) && in_islands(*mate))) {
      rejoin(*mate, dt);
    }
  }
  rigid_.load(dt, bullet_solved_);
  rigid_.clear();
}

void DeformableSystem::Impl::rouse_mates(const Deformable& body, double dt) {
  collect_islands(body);
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    if (in_islands(*objects[i])) {
      rouse_mate(*objects[i], dt);
    }
  }
}

void DeformableSystem::Impl::rouse_mate(btCollisionObject& mate, double dt) {
  if (auto* link = btMultiBodyLinkCollider::upcast(&mate)) {
    mate.activate(true);
    link->m_multiBody->wakeUp();
    return;
  }
  btRigidBody* rigid = btRigidBody::upcast(&mate);
  if (rigid == nullptr || rigid->isStaticOrKinematicObject()) {
    return;
  }
  // Bullet leaves this mark on what it wakes in the middle of a step.
  bool without_gravity = bullet_solved_ && rigid->getActivationState() == WANTS_DEACTIVATION &&
                         rigid->getDeactivationTime() == btScalar(0);
  if (!rigid->isActive()) {
    rigid->activate(true);
    without_gravity = rigid->isActive();
  } else if (!gravity_each_substep_ && !bullet_solved_) {
    without_gravity = rigid->getTotalForce().isZero();  // woken by a callback after the step began
  }
  if (!without_gravity) {
    return;
  }
  if (bullet_solved_ || gravity_each_substep_) {
    rigid->setLinearVelocity(rigid->getLinearVelocity() +
                             btScalar(dt) * rigid->getGravity() * rigid->getLinearFactor());
  }
  if (!gravity_each_substep_) {
    rigid->applyGravity();  // for the solver to come, in this substep or the next
  }
}

// The body takes part in the step again.
void DeformableSystem::Impl::rejoin(Deformable& body, double dt) {
  body.asleep_ = false;
  if (!body.isActive()) {
    body.activate(true);
  }
  const int index = index_of(&body);
  const auto is_mine = [&](const RestingContact& resting) {
    return resting.contact.body == index || resting.contact.object == &body;
  };
  for (RestingContact& resting : resting_contacts_) {
    if (is_mine(resting)) {
      carry_load(resting.contact, dt / resting.dt, dt);
      contacts_.find_or_add(resting.contact) = resting.contact;
    }
  }
  std::erase_if(resting_contacts_, is_mine);
  for (OwnLoad& load : own_loads_) {
    if (load.body == index) {
      carry_own_load(load, dt);
    }
  }
  for (const Handle& held : resting_handles_) {
    if (held.body == index) {
      const auto later = [&](const Handle& h) { return h.id > held.id; };
      carry_load(*handles.insert(std::find_if(handles.begin(), handles.end(), later), held), 1.0, dt);
    }
  }
  std::erase_if(resting_handles_, [&](const Handle& h) { return h.body == index; });
  std::erase_if(surroundings_, [&](const Surrounding& near) { return near.body == &body; });
  add_near_pairs(body);
}

// Pairs of a waking body that this dispatch has already passed over, because both slept.
void DeformableSystem::Impl::add_near_pairs(const Deformable& body) {
  pairs_added_ = true;
  btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    const auto* a = static_cast<const btCollisionObject*>(pairs[i].m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pairs[i].m_pProxy1->m_clientObject);
    if ((a == &body || b == &body) && world.getDispatcher()->needsCollision(a, b)) {
      const btCollisionObject* first = owns(a) ? a : b;
      add_pair(index_of(first), first == a ? b : a);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
