// The stages of one substep. Colliders: placing.cpp; detection: detection.cpp; construction, bodies, handles:
// deformable_system.cpp.
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <LinearMath/btIDebugDraw.h>

#include <algorithm>

#include "deformable_system_impl.h"

namespace softpoint::inline SOFTPOINT_ABI {

bool DeformableSystem::Impl::owns(const btCollisionObject* object) const {
  return std::any_of(bodies.begin(), bodies.end(), [&](const Deformable* body) { return body == object; });
}

void DeformableSystem::Impl::pair_found(const btCollisionObject* deformable, const btCollisionObject* other,
                                        double dt) {
  open_substep(dt, false);
  const int first = index_of(deformable), second = index_of(other);
  wake_by_meeting(first, *other, dt);
  if (second >= 0) {
    wake_by_meeting(second, *deformable, dt);
  }
  add_pair(first, other);
}

void DeformableSystem::Impl::add_pair(int body, const btCollisionObject* other) {
  const int second = index_of(other);
  if (bodies[static_cast<std::size_t>(body)]->asleep() ||
      (second >= 0 && bodies[static_cast<std::size_t>(second)]->asleep())) {
    return;
  }
  // Only a body that wakes in the middle of a dispatch is told of a pair twice.
  if (pairs_added_ && std::any_of(pairs_.begin(), pairs_.end(),
                                  [&](const Pair& p) { return p.body == body && p.other == other; })) {
    return;
  }
  pairs_.push_back({body, other, false});
}

void DeformableSystem::Impl::pair_gone(const btCollisionObject* deformable, const btCollisionObject* other) {
  if (flushing_) {
    return;  // it is about to be found again
  }
  const auto joins = [&](const btCollisionObject* a, const btCollisionObject* b) {
    return (a == deformable && b == other) || (a == other && b == deformable);
  };
  const auto gone = [&](const auto& c) { return joins(bodies[static_cast<std::size_t>(c.body)], c.object); };
  std::erase_if(pairs_,
                [&](const Pair& p) { return joins(bodies[static_cast<std::size_t>(p.body)], p.other); });
  std::erase_if(contact_points, [&](const ContactPoint& p) { return joins(p.body, p.other); });
  lose_surrounding(deformable, other);
  if (std::any_of(contacts_.all().begin(), contacts_.all().end(), gone)) {
    contacts_.erase_if(gone);
  }
  std::erase_if(own_loads_, gone);
}

// Where no pair was near, anchors may still load something.
void DeformableSystem::Impl::before_solving() { open_substep(world.getSolverInfo().m_timeStep, false); }

void DeformableSystem::Impl::all_solved(double dt) {
  bullet_solved_ = true;
  open_substep(dt, true);
  rigid_.take_back();
  wake_the_roused(dt);
  put_to_sleep();
  if (profile.counts.sleeping == static_cast<int>(bodies.size())) {
    solved_ = true;
    return;
  }
  predict(dt);
  place_colliders(dt);
  solve_contacts(dt);
  advance_own(dt);
  rigid_.write_back();
  support_.write_back();
  keep_contacts(dt);
  solved_ = true;
}

void DeformableSystem::Impl::updateAction(btCollisionWorld*, btScalar step) {
  const double dt = step;
  if (!solved_) {  // a world that does not call allSolved: couple after integration, one step late
    ++profile.totals.late_substeps;
    all_solved(dt);
  }
  for (const NearColliders::Impl::LastVelocity& last : last_velocities_) {
    last.body->setLinearVelocity(to_bullet(last.velocity));
    last.body->setAngularVelocity(to_bullet(last.spin));
  }
  last_velocities_.clear();
  if (profile.counts.sleeping < static_cast<int>(bodies.size())) {
    commit(dt);
  }
  last_dt_ = dt;
  open_ = solved_ = bullet_solved_ = pairs_added_ = false;
  ++profile.totals.substeps;
}

void DeformableSystem::Impl::open_substep(double dt, bool solved) {
  if (open_) {
    return;
  }
  open_ = true;
  dt_ = dt;
  profile.seconds = {};
  profile.counts = {};
  pairs_.clear();
  rigid_.clear();
  release_lost_anchors();
  if (restored_) {
    drop_unpaired();
    restored_ = false;
  }
  freeze_the_disabled();
  // Bullet is about to solve the rigid bodies: let it see the load they carried in the last substep, so
  // that a pile under a deformable answers it now. What changes is settled after Bullet.
  const double scale = last_dt_ > 0.0 ? dt / last_dt_ : 0.0;
  for (Contact& contact : contacts_.all()) {
    carry_load(contact, scale, dt);
  }
  for (Handle& held : handles) {
    carry_load(held, scale, dt);
  }
  carry_own_loads(dt);
  rigid_.load(dt, solved);
  rigid_.clear();
  wake_the_roused(dt);
}

void DeformableSystem::Impl::carry_load(Contact& contact, double scale, double dt) {
  contact.impulse *= contact.faded ? 0.5 * scale : scale;
  contact.seen = contact.met = contact.faded = false;
  const Deformable& body = *bodies[static_cast<std::size_t>(contact.body)];
  contact.arm = -from_bullet(contact.object->getWorldTransform().getOrigin());
  for (std::size_t k = 0; k < static_cast<std::size_t>(contact.count); ++k) {
    contact.arm += contact.weights[k] * body.points()[static_cast<std::size_t>(contact.points[k])];
  }
  contact.rigid = rigid_.find_or_add(contact.object, dt);
  rigid_.push(contact.rigid, -contact.impulse, contact.arm);
}

void DeformableSystem::Impl::carry_load(Handle& held, double scale, double dt) {
  held.impulse *= scale;
  if (held.anchored() && !held.own) {
    held.arm = bodies[static_cast<std::size_t>(held.body)]->points()[static_cast<std::size_t>(held.point)] -
               from_bullet(held.object->getWorldTransform().getOrigin());
    held.rigid = rigid_.find_or_add(held.object, dt);
    rigid_.push(held.rigid, -held.impulse, held.arm);
  }
}

void DeformableSystem::Impl::predict(double dt) {
  StageTimer timer(profile.seconds.predict);
  const Vec3 gravity = from_bullet(world.getGravity());
  for (Deformable* body : bodies) {
    if (body->asleep()) {
      continue;
    }
    const long long factored = body->refactorizations_;
    body->solves_contact() ? body->begin_own(dt, gravity) : body->begin(dt, gravity);
    profile.totals.refactorizations += body->refactorizations_ - factored;
  }
  profile.counts.handles = static_cast<int>(handles.size());
  profile.counts.anchors = static_cast<int>(
      std::count_if(handles.begin(), handles.end(), [](const Handle& held) { return held.anchored(); }));
  solver_.begin_step(bodies, dt);
}

// Friction and restitution as the two objects have them now, and the speed of impacts that just begin.
void DeformableSystem::Impl::prepare_contacts(double dt) {
  for (Contact& contact : contacts_.all()) {
    if (!contact.seen) {
      continue;
    }
    const Deformable& body = *bodies[static_cast<std::size_t>(contact.body)];
    contact.friction = gCalculateCombinedFrictionCallback(&body, contact.object);
    contact.restitution = gCalculateCombinedRestitutionCallback(&body, contact.object);
    if (contact.fresh && contact.restitution > 0.0) {
      const RigidState& other = rigid_[contact.rigid];
      Vec3 velocity = -other.velocity_of(contact.arm);
      for (std::size_t k = 0; k < static_cast<std::size_t>(contact.count); ++k) {
        velocity += contact.weights[k] * body.velocities()[static_cast<std::size_t>(contact.points[k])];
      }
      for (std::size_t k = 0; contact.other_body >= 0 && k < static_cast<std::size_t>(contact.other_count);
           ++k) {
        velocity -=
            contact.other_weights[k] * bodies[static_cast<std::size_t>(contact.other_body)]
                                           ->velocities()[static_cast<std::size_t>(contact.other_points[k])];
      }
      // Gravity has already acted over the whole step; what hits is the speed before it (two falling
      // bodies do not feel it).
      const bool both_fall = other.movable() || contact.other_body >= 0;
      contact.fall_speed = both_fall ? 0.0 : std::max(-dt * contact.normal.dot(gravity_on(body)), 0.0);
      const double speed = -contact.normal.dot(velocity) - contact.fall_speed;
      contact.approach = speed > settings.rebound_speed ? speed : 0.0;
    }
    contact.fresh = false;
  }
}

Vec3 DeformableSystem::Impl::gravity_on(const Deformable& body) const {
  return from_bullet(world.getGravity()) + body.acceleration_;
}

void DeformableSystem::Impl::solve_contacts(double dt) {
  const bool none_held =
      std::all_of(handles.begin(), handles.end(), [](const Handle& held) { return held.own; });
  if (placed_.empty() && skin_pairs_.empty() && contacts_.all().empty() && none_held) {
    profile.counts.without_contacts = static_cast<int>(bodies.size()) - profile.counts.sleeping;
    return;
  }
  // A rebound answers the impact of the last substep: the skin has arrived at the surface by now.
  for (Contact& contact : contacts_.all()) {
    // Less the gravity of this step, which the gap it flies in this step has paid for.
    contact.rebound = std::max(contact.restitution * contact.approach - contact.fall_speed, 0.0);
    contact.approach = 0.0;
  }
  // Detection starts from where the forces of the last substep would lead: resting contacts are then found in
  // place, and only impacts are seen to overshoot.
  for (Contact& contact : contacts_.all()) {
    contact.seen = true;
  }
  solver_.warm_start(bodies, contacts_.all(), handles, support_, rigid_, profile);
  for (int pass = 0; pass < settings.max_passes; ++pass) {
    const double violation = detect(pass == 0);
    if (pass > 0 && violation < 0.25 * settings.margin) {
      break;
    }
    prepare_contacts(dt);
    ++profile.counts.passes;
    solver_.solve(bodies, contacts_.all(), handles, support_, rigid_, settings, profile);
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    profile.counts.without_contacts +=
        !bodies[b]->asleep() &&
        std::none_of(contacts_.all().begin(), contacts_.all().end(), [&](const Contact& c) {
          return (c.body == int(b) || c.other_body == int(b)) && c.seen;
        });
  }
}

void DeformableSystem::Impl::keep_contacts(double dt) {
  // Where a handle pulls against what cannot give way, the forces of both would grow from step to step.
  for (Handle& held : handles) {
    if (!held.unreached) {
      continue;
    }
    held.impulse *= 0.5;
    for (Contact& contact : contacts_.all()) {
      contact.faded |= contact.body == held.body;
    }
  }
  // Contacts with objects outside the broadphase's pairs are not kept: nobody would tell when those leave the
  // world.
  for (const Pair& pair : pairs_) {
    if (pair.ahead) {
      for (Contact& contact : contacts_.all()) {
        contact.unpaired |= contact.body == pair.body && contact.object == pair.other;
      }
    }
  }

  contacts_.erase_if([](const Contact& contact) { return !contact.seen || contact.impulse == Vec3::Zero(); });
  profile.counts.contacts = static_cast<int>(contacts_.all().size());
  std::erase_if(contact_points, [](const ContactPoint& p) { return !p.body->asleep(); });
  for (Contact& contact : contacts_.all()) {
    const Deformable& body = *bodies[static_cast<std::size_t>(contact.body)];
    ContactPoint point;
    point.body = &body;
    point.other = contact.object;
    for (std::size_t k = 0; k < static_cast<std::size_t>(contact.count); ++k) {
      point.point += contact.weights[k] * body.end_positions_[static_cast<std::size_t>(contact.points[k])];
    }
    point.normal = contact.normal;
    point.force = contact.impulse / dt;
    // What is left, not what was solved for.
    point.gap = contact.normal.dot(point.point - other_point(contact));
    contact_points.push_back(point);
  }
  for (const OwnLoad& load : own_loads_) {
    const Deformable& body = *bodies[static_cast<std::size_t>(load.body)];
    const Vec3& impulse = load.wrench.impulse;
    if (!body.asleep() && !impulse.isZero(0)) {
      ContactPoint point;  // all of it as one force on its line
      point.body = &body;
      point.other = load.object;
      point.point = from_bullet(load.object->getWorldTransform().getOrigin()) +
                    impulse.cross(load.wrench.moment) / impulse.squaredNorm();
      point.normal = -impulse.normalized();
      point.force = -impulse / dt;
      contact_points.push_back(point);
    }
  }
  contacts_.erase_if([](const Contact& contact) { return contact.unpaired; });
}

// What the guard has put back must not be poisoned again by the impulses that led there.
void DeformableSystem::Impl::forget_impulses(int body) {
  contacts_.erase_if([&](const Contact& c) { return c.body == body || c.other_body == body; });
  std::erase_if(own_loads_, [&](const OwnLoad& load) { return load.body == body; });
  for (Handle& held : handles) {
    if (held.body == body) {
      held.impulse.setZero();
    }
  }
}

void DeformableSystem::Impl::commit(double dt) {
  {
    StageTimer timer(profile.seconds.commit);
    for (Deformable* body : bodies) {
      if (body->asleep()) {
        continue;
      }
      const long long fired = body->guard_fired();
      body->finish(dt);
      if (body->guard_fired() != fired) {
        ++profile.totals.guard_fired;
        forget_impulses(index_of(body));
      }
    }
    settle_rest(dt);
  }
  StageTimer timer(profile.seconds.mirror);
  for (Deformable* body : bodies) {
    if (!body->asleep()) {
      body->mirror(dt);
      profile.counts.normals += body->mirrored_normals();
    }
  }
}

void DeformableSystem::Impl::debugDraw(btIDebugDraw* drawer) {
  for (const ContactPoint& contact : contact_points) {
    drawer->drawContactPoint(to_bullet(contact.point), to_bullet(contact.normal), btScalar(contact.gap), 0,
                             btVector3(1, 1, 0));
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
