// Sleeping and waking together with Bullet's simulation islands.
//
// Bullet merges a deformable with every rigid body in its bounds into one island and puts the island to sleep
// when all of it agrees. What it cannot know for us, since we have no manifolds: kinematic and static objects
// that move, and that a sleeping pile needs its load and its gravity in the very step in which it wakes.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>

#include <algorithm>

#include "deformable_system_impl.h"
#include "rest.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Whether Bullet will find that it agrees to sleep when this step of `dt` ends.
bool agrees(const btCollisionObject& object, double dt) {
  if (object.isStaticOrKinematicObject() || !object.isActive() ||
      object.getActivationState() == WANTS_DEACTIVATION) {
    return true;
  }
  const btRigidBody* rigid = btRigidBody::upcast(&object);
  return rigid != nullptr && rigid->getActivationState() == ACTIVE_TAG && !gDisableDeactivation &&
         rigid->getLinearVelocity().length() < rigid->getLinearSleepingThreshold() &&
         rigid->getAngularVelocity().length() < rigid->getAngularSleepingThreshold() &&
         rigid->getDeactivationTime() + btScalar(dt) > gDeactivationTime;
}

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

// Counts the time at rest; whether that is enough to sleep.
bool Deformable::rested(double dt, bool quiet) {
  if (getActivationState() == DISABLE_DEACTIVATION) {
    return false;
  }
  if (!quiet || !(max_speed() < sleep_settings_.speed)) {
    setDeactivationTime(0);
    setActivationState(ACTIVE_TAG);
    return false;
  }
  setDeactivationTime(static_cast<btScalar>(getDeactivationTime() + dt));
  const bool forbidden = gDisableDeactivation || (!sleep_settings_.time && gDeactivationTime == btScalar(0));
  if (forbidden) {
    setActivationState(ACTIVE_TAG);
  }
  return !forbidden && getDeactivationTime() > sleep_settings_.time.value_or(gDeactivationTime);
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

// A body beside or tied to a kinematic object that moves is not left at rest for long.
bool DeformableSystem::Impl::is_quiet(const Deformable& body) const {
  const auto carried = [&](int index, const btCollisionObject* object) {
    return object != nullptr && bodies[static_cast<std::size_t>(index)] == &body &&
           object->isKinematicObject() && moves(*object);
  };
  return std::none_of(pairs_.begin(), pairs_.end(),
                      [&](const Pair& p) { return carried(p.body, p.other); }) &&
         std::none_of(handles.begin(), handles.end(),
                      [&](const Handle& held) { return carried(held.body, held.object); });
}

// Bullet's islands know nothing of anchors. A body and what it is tied to fall asleep in the same step: the
// body keeps the others awake until it is at rest itself, and then waits for them.
void DeformableSystem::Impl::settle_rest(double dt) {
  for (Deformable* body : bodies) {
    if (body->asleep_ || frozen(*body)) {
      continue;
    }
    if (body->rested(dt, is_quiet(*body))) {
      if (ties_agree(*body, dt)) {
        body->setActivationState(WANTS_DEACTIVATION);
      }
      continue;
    }
    for (const Handle& held : handles) {
      auto* object = const_cast<btCollisionObject*>(held.object);
      if (object != nullptr && bodies[static_cast<std::size_t>(held.body)] == body &&
          !object->isStaticOrKinematicObject() && object->isActive()) {
        object->activate();
      }
    }
  }
}

bool DeformableSystem::Impl::ties_agree(const Deformable& body, double dt) const {
  return std::all_of(handles.begin(), handles.end(), [&](const Handle& held) {
    return bodies[static_cast<std::size_t>(held.body)] != &body || !held.anchored() ||
           agrees(*held.object, dt);
  });
}

bool DeformableSystem::Impl::tied_to_awake(const Deformable& body) const {
  const auto awake = [&](const Handle& held) {
    return bodies[static_cast<std::size_t>(held.body)] == &body && held.anchored() &&
           !held.object->isStaticOrKinematicObject() && held.object->isActive();
  };
  return std::any_of(handles.begin(), handles.end(), awake) ||
         std::any_of(resting_handles_.begin(), resting_handles_.end(), awake);
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
    if (body->asleep_) {
      continue;
    }
    if (body->isActive() || tied_to_awake(*body)) {
      continue;
    }
    part(*body);
    ++profile.counts.sleeping;
  }
  // What is tied together and did not agree stays awake together.
  for (Deformable* body : bodies) {
    if (!body->asleep_ && !body->isActive()) {
      body->activate(true);
      rouse_mates(*body, dt_);
    }
  }
  for (const Handle& held : handles) {
    if (held.anchored() && !held.object->isActive()) {
      rouse_mate(*const_cast<btCollisionObject*>(held.object), dt_);
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
    // Without an algorithm nobody would tell when the other leaves the world.
    if ((a == &body || b == &body) && pairs[i].m_algorithm != nullptr && other->isStaticOrKinematicObject() &&
        other->hasContactResponse()) {
      surroundings_.push_back({&body, other, other->getWorldTransform()});
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
