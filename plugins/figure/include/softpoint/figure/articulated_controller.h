#pragma once

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>

#include "softpoint/figure/figure_animation.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// A figure in a Bullet world, any of the stock ones: each of its capsules is a kinematic rigid body that goes
// where the figure goes, with its velocity, and pushes what is in the way. An action of the world: it moves
// on by itself with every substep. Destroy it before the world.
class SOFTPOINT_API ArticulatedController final : public btActionInterface {
 public:
  // Puts the capsules into the world. `animation` was evaluated, is kept by reference and plays from its
  // beginning; after its end the figure stands still. Throws Error if it was not evaluated or has no
  // capsules.
  ArticulatedController(btDiscreteDynamicsWorld& world, const FigureAnimation& animation,
                        int group = btBroadphaseProxy::KinematicFilter,
                        int mask = btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter ^
                                   btBroadphaseProxy::KinematicFilter);
  ~ArticulatedController() override;
  ArticulatedController(const ArticulatedController&) = delete;
  ArticulatedController& operator=(const ArticulatedController&) = delete;

  const FigureAnimation& animation() const;
  const FigureState& state() const;
  double time() const;  // s, since the beginning of the animation
  // Plays on from another time (s); what is published has no velocity in that step.
  void set_time(double time);

  int body_count() const;          // as many as capsules
  btRigidBody& body(int capsule);  // for materials; its motion is the controller's
  const btRigidBody& body(int capsule) const;

  void updateAction(btCollisionWorld* world, btScalar dt) override;
  void debugDraw(btIDebugDraw* drawer) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
