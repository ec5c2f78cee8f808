#pragma once

#include "softpoint/core/deformable_system.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A point of a deformable held at a target: a place in the world (DeformableSystem::grab) or a point of a
// collision object (DeformableSystem::attach), which feels the opposite impulse.
struct Handle {
  HandleId id = 0;
  int body = 0;
  int point = 0;
  Vec3 target = Vec3::Zero();   // m, in the world or in the object's frame
  double max_force = 0;         // N
  Vec3 impulse = Vec3::Zero();  // N s on the body over the substep
  bool unreached = false;       // the point was not brought to the target although force is left

  const btCollisionObject* object = nullptr;  // null: the world
  bool collide = true;                        // body and object still collide
  bool own = false;                           // the body solves its handles itself
  int object_index = 0;                       // where the world's list last had the object
  int rigid = -1;                             // index into RigidStates, this substep
  Vec3 arm = Vec3::Zero();                    // m, of the impulse from the object's centre of mass

  bool anchored() const { return object != nullptr; }
};

}  // namespace softpoint::inline SOFTPOINT_ABI
