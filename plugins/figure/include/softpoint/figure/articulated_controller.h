#pragma once

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <span>

#include "softpoint/figure/figure_animation.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

struct ControllerSettings {
  double max_step = 1.0 / 240;  // s, of the dynamics at run time
  double return_time = 0.3;     // s, that joints handed back take to be with the animation again
  // The clip's own dynamic intervals (and, with PlaceRule::kContact, its base) are simulated here once more,
  // and feel the world.
  bool live = false;
};

// What run-time dynamics have come to since construction.
struct ControllerCounts {
  long long handovers = 0;             // times that the set of dynamic joints changed
  long long contacts = 0;              // points that could press
  long long forward_calls = 0;         // forward dynamics
  long long boxes_overlapping = 0;     // capsules and objects whose boxes met where a contact was looked for,
  long long narrow_tests = 0;          // and tests of two such shapes
  long long guard_fired = 0;           // steps that would not have been finite and were left out
  Vec3 impulse = Vec3::Zero();         // N s, of the world on the figure, and
  Vec3 impulse_moment = Vec3::Zero();  // N m s, about the world's origin; the world got the opposite
};

// A figure in a Bullet world, any of the stock ones: each of its capsules is a kinematic rigid body that goes
// where the figure goes, with its velocity, and pushes what is in the way. An action of the world: it moves
// on by itself with every substep. Destroy it before the world.
//
// Joints can be handed to zero-torque dynamics and back at any time. Capsules that dynamic joints carry are
// pushed back: they exchange impulses with rigid bodies, inelastic, with Bullet's friction, and the figure's
// whole articulated inertia; all else (links of multibodies too) counts as fixed. Boxes, spheres, capsules,
// planes and compounds of them are met in closed form, within the step and before they are gone through:
// after it no limp capsule is deeper than 0.1 mm where its joints can give way. Other shapes are met where
// Bullet has found contacts. Soft bodies pass through.
class SOFTPOINT_API ArticulatedController final : public btActionInterface {
 public:
  // Puts the capsules into the world. `animation` was evaluated, is kept by reference and plays from its
  // beginning; after its end the figure stands still. Throws Error if it was not evaluated or has no
  // capsules, or for settings out of range. `mask` is widened to fixed bodies while joints are dynamic.
  ArticulatedController(btDiscreteDynamicsWorld& world, const FigureAnimation& animation,
                        int group = btBroadphaseProxy::KinematicFilter,
                        int mask = btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter ^
                                   btBroadphaseProxy::KinematicFilter,
                        const ControllerSettings& settings = {});
  ~ArticulatedController() override;
  ArticulatedController(const ArticulatedController&) = delete;
  ArticulatedController& operator=(const ArticulatedController&) = delete;

  const FigureAnimation& animation() const;
  const FigureState& state() const;
  double time() const;  // s, since the beginning of the animation
  // Plays on from another time (s), by the animation alone; what is published has no velocity in that step.
  void set_time(double time);

  // Which links' joints are dynamic from now on, one flag a link: the free base is one of them. Positions and
  // rates go on as they are, both ways. A joint that is outside its range then may not go further out.
  void set_dynamic(std::span<const bool> links);
  // The same for a link and all that hangs on it.
  void hand_over(int link, bool dynamic);
  bool dynamic(int link) const;
  const ControllerCounts& counts() const;

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
