#pragma once

#include "collider_shape.h"
#include "rigid_state.h"
#include "softpoint/core/near_colliders.h"
#include "support_contacts.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Impulse (N s) and moment (N m s) about the centre of mass of a collider.
struct Wrench {
  Vec3 impulse = Vec3::Zero();
  Vec3 moment = Vec3::Zero();
};

// Storage is kept from step to step.
struct __attribute__((visibility("hidden"))) NearColliders::Impl {
  struct Body {
    Collider seen;
    int rigid = -1;                                                 // among the rigid states
    Pose pose;                                                      // now
    Vec3 first_velocity = Vec3::Zero(), first_spin = Vec3::Zero();  // at the start of the step
    Wrench carried;  // from the last step, acting as if by Bullet
    Wrench load;     // of this step so far
    bool pushed = false;
  };
  struct Part {
    Piece seen;
    const ColliderShape* shape = nullptr;
    Pose local;
    std::span<signed char> sides;
  };

  void clear(RigidStates& states, SupportContacts& contacts, double dt);
  // Index of the collider with this rigid state, added when new.
  int body(int rigid, double friction);
  void add_part(int collider, int child, const ColliderShape& shape, const Pose& local,
                std::span<signed char> sides);
  // Gives the colliders the velocity that puts them where they have come to, and keeps that which they have
  // now in `last`.
  struct LastVelocity {
    btRigidBody* body;
    Vec3 velocity, spin;
  };
  void settle(std::vector<LastVelocity>& last);

  RigidStates* rigid = nullptr;
  SupportContacts* support = nullptr;
  double step = 0;  // s
  std::vector<Body> bodies;
  std::vector<Part> parts;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
