#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>
#include <optional>
#include <span>

#include "softpoint/core/deformable.h"
#include "softpoint/core/profile.h"
#include "softpoint/core/snapshot.h"

namespace softpoint::inline SOFTPOINT_ABI {

// How contact is solved. The defaults are the knee of cost against error at 1/60 s.
struct ContactSettings {
  double margin = 1e-3;  // m, gap kept between skin and collider; 1e-5 to 0.1
  double tolerance =
      1e-6;  // m, 1e-12 to 1e-2; a Gauss-Seidel sweep that moves no contact by more ends the solve
  int max_iterations = 250;    // Gauss-Seidel sweeps a pass, 1 to 10000
  int max_passes = 8;          // detection and solution rounds a substep, 1 to 20
  double rebound_speed = 0.2;  // m/s, slower impacts do not bounce; 0 to 1e6
  bool rigid_support = true;   // solve rigid-rigid contacts of touched piles together with ours
};
// Throws Error naming the field, its value and the permitted range.
SOFTPOINT_API void check(const ContactSettings& settings);

// One contact point of the last substep.
struct ContactPoint {
  const Deformable* body = nullptr;          // whose skin is touched
  const btCollisionObject* other = nullptr;  // the collider
  Vec3 point = Vec3::Zero();                 // m, world, on the skin
  Vec3 normal = Vec3::Zero();                // from the collider towards the body
  Vec3 force = Vec3::Zero();  // N on the body, mean over the substep; the collider feels its opposite
  double gap = 0;             // m, negative in penetration
};

// A point of a deformable met by a ray.
struct RayHit {
  Deformable* body = nullptr;    // met first
  int face = -1;                 // of it
  int point = -1;                // the face's vertex nearest to the hit
  Vec3 weights = Vec3::Zero();   // barycentric, in the face
  Vec3 position = Vec3::Zero();  // m
  double fraction = 0;           // 0 at `from`, 1 at `to`
};

// Identifies a handle; never reused within a system.
using HandleId = long long;

// Ties deformables to one btDiscreteDynamicsWorld or any of its four stock descendants, unpatched.
// Construction attaches (one action, a tap behind the constraint solver, collision functions for soft
// shapes), destruction detaches and leaves the world as it was. Destroy it before the world, and do
// not replace the world's constraint solver in between. One system per world.
//
//   btDiscreteDynamicsWorld world(...);
//   softpoint::DeformableSystem soft(world);
//   soft.add(body);
//   world.stepSimulation(dt);
class SOFTPOINT_API DeformableSystem {
 public:
  // Throws Error for settings out of range and for a world whose dispatcher is no btCollisionDispatcher.
  explicit DeformableSystem(btDiscreteDynamicsWorld& world, const ContactSettings& settings = {});
  ~DeformableSystem();
  DeformableSystem(const DeformableSystem&) = delete;
  DeformableSystem& operator=(const DeformableSystem&) = delete;

  // The body stays the caller's; destroying it removes it.
  void add(Deformable& body, int group = btBroadphaseProxy::DefaultFilter,
           int mask = btBroadphaseProxy::AllFilter);
  // Takes it out of the world and lets go of its handles.
  void remove(Deformable& body);
  // In the order in which they were added.
  std::span<Deformable* const> bodies() const;

  // Nearest face hit by the segment from..to (m), in any world.
  std::optional<RayHit> pick(const Vec3& from, const Vec3& to) const;

  // Dragging. A handle holds one point of a body at `target` (m) from the next step on; max_force (N)
  // limits its pull, infinity makes it a pin that is moved exactly. Where several hold one point, all pull;
  // of several pins the last one given holds.
  HandleId grab(Deformable& body, int point, const Vec3& target,
                double max_force = std::numeric_limits<double>::infinity());
  // Anchors: handles whose target is a point of a rigid body, a multibody's link or any other collision
  // object of the world: `local` (m) in the frame of its world transform, or where the point is now. What
  // moves by impulses feels the opposite ones. With `collide` false the two do not collide while the anchor
  // holds. An object that leaves the world takes its anchors with it.
  HandleId attach(Deformable& body, int point, const btCollisionObject& to, const Vec3& local,
                  double max_force = std::numeric_limits<double>::infinity(), bool collide = false);
  HandleId attach(Deformable& body, int point, const btCollisionObject& to,
                  double max_force = std::numeric_limits<double>::infinity(), bool collide = false);
  // A new target (m), for the steps to come; that of an anchor in its object's frame.
  void move(HandleId handle, const Vec3& target);
  // Whether a handle still exists: false after its release, when its body or its object has gone.
  bool holds(HandleId handle) const;
  // Lets go.
  void release(HandleId handle);
  // Force of a handle on its body in the last substep (N).
  Vec3 handle_force(HandleId handle) const;

  // Contact points of the last substep that pushed.
  std::span<const ContactPoint> contacts() const;

  // Snapshots, between two steps. Restoring asks for the same bodies, added in the same order, and the same
  // number of collision objects in the world; Error names what differs, and nothing has changed then. Bullet
  // cannot restore its caches of rigid contacts: for two runs to go on with the same bits, flush them in
  // both, right after save() (restore() of a snapshot of the world does it itself).
  Snapshot save(SnapshotScope scope = SnapshotScope::deformables) const;
  // The same into storage that is used again.
  void save(Snapshot& into, SnapshotScope scope = SnapshotScope::deformables) const;
  // Takes the state over.
  void restore(const Snapshot& snapshot);
  // All of Bullet's pairs and contact points of this world are found anew in the next step.
  void flush_contact_caches();

  const Profile& profile() const;           // of the last substep, and totals
  const ContactSettings& settings() const;  // in force
  // From the next substep on. Throws Error for what is out of range.
  void set_settings(const ContactSettings& settings);
  btDiscreteDynamicsWorld& world() const;  // the one attached to

 private:
  friend class Deformable;
  void wake_island(Deformable& body);

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
