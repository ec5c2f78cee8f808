#pragma once

#include <cstdint>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "softpoint/core/state_archive.h"

namespace softpoint {

// Of the bits of all that moves: points and velocities of deformables, poses and velocities of rigid bodies,
// forces of contacts.
inline std::uint64_t bits_of(const DeformableSystem& system) {
  std::uint64_t hash = state_hash(nullptr, 0);
  const auto add = [&](const auto* data, std::size_t count) {
    hash = state_hash(data, count * sizeof *data, hash);
  };
  for (const Deformable* body : system.bodies()) {
    add(body->points().data(), body->points().size());
    add(body->velocities().data(), body->velocities().size());
    const bool asleep = body->asleep();
    add(&asleep, 1);
  }
  for (const ContactPoint& contact : system.contacts()) {
    add(&contact.force, 1);
    add(&contact.point, 1);
  }
  const btCollisionObjectArray& objects = system.world().getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    const btRigidBody* body = btRigidBody::upcast(objects[i]);
    if (body == nullptr) continue;
    for (const btVector3& v :
         {body->getWorldTransform().getOrigin(), body->getWorldTransform().getBasis()[0],
          body->getWorldTransform().getBasis()[1], body->getWorldTransform().getBasis()[2],
          body->getLinearVelocity(), body->getAngularVelocity()}) {
      add(&v[0], 3);
    }
  }
  return hash;
}

// One hash a step.
template <class World>
std::vector<std::uint64_t> play(World& world, const DeformableSystem& system, int steps) {
  std::vector<std::uint64_t> bits;
  for (int i = 0; i < steps; ++i) {
    world.step();
    bits.push_back(bits_of(system));
  }
  return bits;
}

// The first step at which two runs differ, or -1.
inline int first_difference(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    if (a[i] != b[i]) return static_cast<int>(i);
  }
  return a.size() == b.size() ? -1 : static_cast<int>(a.size() < b.size() ? a.size() : b.size());
}

}  // namespace softpoint
