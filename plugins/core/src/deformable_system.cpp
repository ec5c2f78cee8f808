#include "softpoint/core/deformable_system.h"

#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>

#include <algorithm>
#include <cmath>

#include "deformable_system_impl.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

btCollisionDispatcher& dispatcher_of(btDiscreteDynamicsWorld& world) {
  auto* dispatcher = dynamic_cast<btCollisionDispatcher*>(world.getDispatcher());
  if (dispatcher == nullptr) {
    throw Error(
        "DeformableSystem: the world's dispatcher is of an unknown kind; permitted is a "
        "btCollisionDispatcher");
  }
  return *dispatcher;
}

}  // namespace

void check(const ContactSettings& s) {
  check_range("ContactSettings.margin", s.margin, 1e-5, 0.1);
  check_range("ContactSettings.tolerance", s.tolerance, 1e-12, 1e-2);
  check_range("ContactSettings.max_iterations", s.max_iterations, 1, 10000);
  check_range("ContactSettings.max_passes", s.max_passes, 1, 20);
  check_range("ContactSettings.rebound_speed", s.rebound_speed, 0.0, kMaxSpeed);
}

DeformableSystem::Impl::Impl(btDiscreteDynamicsWorld& w, const ContactSettings& s)
    : world(w),
      settings(s),
      tap_(w, *this),
      pairs_hook_(dispatcher_of(w), *this),
      known_gravity_(w.getGravity()),
      gravity_each_substep_(dynamic_cast<btDeformableMultiBodyDynamicsWorld*>(&w) != nullptr) {
  world.addAction(this);
}

DeformableSystem::Impl::~Impl() { world.removeAction(this); }

DeformableSystem::DeformableSystem(btDiscreteDynamicsWorld& world, const ContactSettings& settings) {
  check(settings);
  impl_ = std::make_unique<Impl>(world, settings);
}

DeformableSystem::~DeformableSystem() {
  while (!impl_->bodies.empty()) {
    remove(*impl_->bodies.back());
  }
}

void DeformableSystem::add(Deformable& body, int group, int mask) {
  if (body.system_ != nullptr) {
    throw Error("DeformableSystem::add: the body is already in a system; permitted is a body in none");
  }
  body.system_ = this;
  impl_->bodies.push_back(&body);
  body.activate(true);
  body.mirror(1.0 / 60.0);
  impl_->world.addCollisionObject(&body, group, mask);
}

void DeformableSystem::remove(Deformable& body) {
  if (body.system_ != this) {
    throw Error("DeformableSystem::remove: the body is not in this system");
  }
  impl_->world.removeCollisionObject(&body);
  impl_->forget(body);
  body.system_ = nullptr;
  body.asleep_ = false;
}

void DeformableSystem::Impl::forget(const Deformable& body) {
  const int gone = index_of(&body);
  const auto of_body = [&](const auto& c) { return c.body == gone || c.object == &body; };
  contacts_.erase_if(of_body);
  std::erase_if(resting_contacts_, [&](const RestingContact& r) { return of_body(r.contact); });
  std::erase_if(own_loads_, of_body);
  std::erase_if(mesh_sides_, [&](const MeshSides& sides) { return sides.body == &body; });
  patches_.forget_body(gone);
  for (std::vector<Handle>* list : {&handles, &resting_handles_}) {
    std::erase_if(*list, [&](const Handle& h) {
      if (h.body == gone) {
        let_go(h);
      }
      return h.body == gone;
    });
  }
  std::erase_if(surroundings_, [&](const Surrounding& s) { return s.body == &body; });
  std::erase_if(pairs_, [&](const Pair& p) { return p.body == gone || p.other == &body; });
  std::erase_if(contact_points, [&](const ContactPoint& p) { return p.body == &body || p.other == &body; });
  for (Contact& contact : contacts_.all()) {
    contact.body -= contact.body > gone;
    contact.other_body -= contact.other_body > gone;
  }
  contacts_.reindex();
  for (OwnLoad& load : own_loads_) {
    load.body -= load.body > gone;
  }
  for (RestingContact& resting : resting_contacts_) {
    resting.contact.body -= resting.contact.body > gone;
    resting.contact.other_body -= resting.contact.other_body > gone;
  }
  for (std::vector<Handle>* list : {&handles, &resting_handles_}) {
    for (Handle& h : *list) {
      h.body -= h.body > gone;
    }
  }
  bodies.erase(bodies.begin() + gone);
}

std::span<Deformable* const> DeformableSystem::bodies() const { return impl_->bodies; }

int DeformableSystem::Impl::index_of(const btCollisionObject* object) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b] == object) {
      return static_cast<int>(b);
    }
  }
  return -1;
}

std::span<const ContactPoint> DeformableSystem::contacts() const { return impl_->contact_points; }
const Profile& DeformableSystem::profile() const { return impl_->profile; }
const ContactSettings& DeformableSystem::settings() const { return impl_->settings; }
btDiscreteDynamicsWorld& DeformableSystem::world() const { return impl_->world; }

void DeformableSystem::set_settings(const ContactSettings& settings) {
  check(settings);
  impl_->settings = settings;
  for (Deformable* body : impl_->bodies) {
    body->wake();
  }
}

void DeformableSystem::wake_island(Deformable& body) { impl_->wake_mates(body); }

}  // namespace softpoint::inline SOFTPOINT_ABI
