// Sleeping and waking together with Bullet's simulation islands.
//
// Bullet merges a deformable with every rigid body in its bounds into one island and puts the island to sleep
// when all of it agrees. What it cannot know for us, since we have no manifolds: kinematic and static objects
// that move, and that a sleeping pile needs its load and its gravity in the very step in which it wakes.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>

#include "deformable_system_impl.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

bool moves(const btCollisionObject& object) {
  const btRigidBody* rigid = btRigidBody::upcast(&object);
  return rigid != nullptr && !rigid->isStaticObject() &&
         !(rigid->getLinearVelocity().isZero() && rigid->getAngularVelocity().isZero());
}

// Awake and not about to sleep, or a kinematic object on its way.
bool restless(const btCollisionObject& object) {
  return object.isStaticOrKinematicObject() ? moves(object)
                                            : object.getActivationState() == ACTIVE_TAG ||
                                                  object.getActivationState() == DISABLE_DEACTIVATION;
}

bool frozen(const Deformable& body) { return body.getActivationState() == DISABLE_SIMULATION; }

}  // namespace

void check(const SleepSettings& settings) {
  check_range("SleepSettings.speed", settings.speed, 0.0, 1e6);
  if (settings.time) {
    check_range("SleepSettings.time", *settings.time, 0.0, 1e6);
  }
}

void Deformable::set_sleep_settings(const SleepSettings& settings) {
  check(settings);
  sleep_settings_ = settings;
  wake();
}

void Deformable::wake() {
  if (asleep_ && system_ != nullptr) {
    system_->wake_island(*this);
  }
  activate(true);
}

double Deformable::max_speed() const {
  double squared = 0.0;
  for (const Vec3& v : velocities_) {
    squared = std::max(squared, v.squaredNorm());
  }
  return std::sqrt(squared);
}

void Deformable::update_deactivation(double dt, bool quiet) {
  if (getActivationState() == DISABLE_DEACTIVATION) {
    return;
  }
  if (!quiet || !(max_speed() < sleep_settings_.speed)) {
    setDeactivationTime(0);
    setActivationState(ACTIVE_TAG);
    return;
  }
  setDeactivationTime(static_cast<btScalar>(getDeactivationTime() + dt));
  const bool forbidden = gDisableDeactivation || (!sleep_settings_.time && gDeactivationTime == btScalar(0));
  if (forbidden) {
    setActivationState(ACTIVE_TAG);
  } else if (getDeactivationTime() > sleep_settings_.time.value_or(gDeactivationTime)) {
    setActivationState(WANTS_DEACTIVATION);
  }
}

void Deformable::fall_asleep() {
  asleep_ = true;
  if (frozen(*this)) {
    return;  // keeps its velocity, as a rigid body does
  }
  std::fill(velocities_.begin(), velocities_.end(), Vec3::Zero());
  for (int i = 0; i < m_nodes.size(); ++i) {
    m_nodes[i].m_q = m_nodes[i].m_x;
    m_nodes[i].m_v.setZero();
  }
}

// A body beside a kinematic object that moves is not left at rest for long, nor one tied to something that is
// not at rest itself.
bool DeformableSystem::Impl::is_quiet(const Deformable& body) const {
  const bool tied = std::any_of(handles.begin(), handles.end(), [&](const Handle& held) {
    return bodies[static_cast<std::size_t>(held.body)] == &body && held.anchored() && restless(*held.object);
  });
  return !tied && std::none_of(pairs_.begin(), pairs_.end(), [&](const Pair& pair) {
    return bodies[static_cast<std::size_t>(pair.body)] == &body && pair.other->isKinematicObject() &&
           moves(*pair.other);
  });
}

bool DeformableSystem::Impl::surroundings_moved(const Deformable& body) const {
  const bool tied = std::any_of(resting_handles_.begin(), resting_handles_.end(), [&](const Handle& held) {
    return bodies[static_cast<std::size_t>(held.body)] == &body && held.anchored() && restless(*held.object);
  });
  return tied || std::any_of(surroundings_.begin(), surroundings_.end(), [&](const Surrounding& near) {
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
  if (std::erase_if(resting_contacts_, lost) > 0) {
    const_cast<btCollisionObject*>(deformable)->activate(true);
    wake_mates(*static_cast<const Deformable*>(deformable));
  }
}

// Between two steps: Bullet gives gravity to what is awake when a step begins.
void DeformableSystem::Impl::wake_mates(const Deformable& body) {
  if (body.getIslandTag() < 0 || frozen(body)) {
    return;
  }
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    btCollisionObject& mate = *objects[i];
    if (&mate == &body || mate.getIslandTag() != body.getIslandTag()) {
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
  const int island = body.getIslandTag();
  btCollisionObjectArray& objects = world.getCollisionObjectArray();
  for (int i = 0; island >= 0 && i < objects.size(); ++i) {
    if (objects[i]->getIslandTag() == island) {
      rouse_mate(*objects[i], dt);
    }
  }
  for (Deformable* mate : bodies) {
    if (mate == &body || (island >= 0 && mate->getIslandTag() == island && mate->asleep_ && !frozen(*mate))) {
      rejoin(*mate, dt);
    }
  }
  rigid_.load(dt, bullet_solved_);
  rigid_.clear();
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

void DeformableSystem::Impl::freeze_the_disabled() {
  for (Deformable* body : bodies) {
    if (!body->asleep_ && frozen(*body)) {
      part(*body);
    }
  }
}

void DeformableSystem::Impl::put_to_sleep() {
  for (Deformable* body : bodies) {
    if (!body->asleep_ && !body->isActive()) {
      part(*body);
      ++profile.counts.sleeping;
    }
  }
}

// The body leaves the step: its contacts and handles wait for its waking.
void DeformableSystem::Impl::part(Deformable& body) {
  const int index = index_of(&body);
  body.fall_asleep();
  const auto is_mine = [&](const Contact& contact) {
    return contact.body == index || contact.object == &body;
  };
  if (frozen(body)) {
    std::erase_if(contact_points,
                  [&](const ContactPoint& point) { return point.body == &body || point.other == &body; });
  } else {
    for (const Contact& contact : contacts_.all()) {
      if (is_mine(contact)) {
        resting_contacts_.push_back({contact, dt_});
      }
    }
  }
  contacts_.erase_if(is_mine);
  for (Handle& held : handles) {
    if (held.body == index) {
      held.unreached = false;
      resting_handles_.push_back(held);
    }
  }
  for (const Handle& held : resting_handles_) {
    if (held.body == index && held.anchored() && held.object->isStaticOrKinematicObject()) {
      surroundings_.push_back({&body, held.object, held.object->getWorldTransform()});
    }
  }
  std::erase_if(handles, [&](const Handle& held) { return held.body == index; });
  std::erase_if(pairs_, [&](const Pair& pair) { return pair.body == index; });
  const btBroadphasePairArray& pairs = world.getPairCache()->getOverlappingPairArray();
  for (int i = 0; i < pairs.size(); ++i) {
    const auto* a = static_cast<const btCollisionObject*>(pairs[i].m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pairs[i].m_pProxy1->m_clientObject);
    const btCollisionObject* other = a == &body ? b : a;
    if ((a == &body || b == &body) && other->isStaticOrKinematicObject() && other->hasContactResponse()) {
      surroundings_.push_back({&body, other, other->getWorldTransform()});
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
