#pragma once

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

#include <vector>

#include "rigid_state.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Bullet's own rigid-rigid contact points among the colliders a deformable touches. Bullet solved them
// before it knew our impulses; re-solving their change here lets a load go through a pile to the floor
// within the same step.
class SupportContacts {
 public:
  // Collects the manifolds of all islands that `rigid` already holds a movable body of; adds the other
  // bodies of these manifolds to `rigid`.
  void collect(btDispatcher& dispatcher, RigidStates& rigid, double dt);
  void clear() { rows_.clear(); }
  int size() const { return static_cast<int>(rows_.size()); }
  // Puts the impulses found so far back on colliders that start again from their free velocities.
  void reapply(RigidStates& rigid) const;
  // One Gauss-Seidel sweep; returns the largest change of a contact point over the step (m).
  double sweep(RigidStates& rigid, double dt);
  // Add the impulses found here to Bullet's, which warm-start its next step.
  void write_back();

 private:
  struct Row {
    btManifoldPoint* point = nullptr;
    int a = -1, b = -1;  // RigidStates
    Vec3 arm_a, arm_b;
    Vec3 normal;  // from b to a
    std::array<Vec3, 2> tangents;
    double gain = 0;  // 1 / (n . K n)
    std::array<double, 2> tangent_gain{};
    double floor_speed = 0;  // m/s, lowest permitted separation speed
    double friction = 0;
    double impulse = 0;  // N s, Bullet's and ours
    std::array<double, 2> friction_impulse{};
    double bullet_impulse = 0;  // N s, Bullet's alone
    std::array<double, 2> bullet_friction{};
  };
  void add(btManifoldPoint& point, int a, int b, const RigidStates& rigid, double dt);

  std::vector<Row> rows_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
