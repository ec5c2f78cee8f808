#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Whether a rigid body, a kinematic one by the application, is on its way.
inline bool moves(const btCollisionObject& object) {
  const btRigidBody* rigid = btRigidBody::upcast(&object);
  return rigid != nullptr && !rigid->isStaticObject() &&
         !(rigid->getLinearVelocity().isZero() && rigid->getAngularVelocity().isZero());
}

// Put out of the simulation by the application.
inline bool frozen(const Deformable& body) { return body.getActivationState() == DISABLE_SIMULATION; }

}  // namespace softpoint::inline SOFTPOINT_ABI
