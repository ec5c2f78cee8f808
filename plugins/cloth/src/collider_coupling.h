#pragma once

#include <span>
#include <vector>

#include "cloth_solver.h"
#include "contact_gatherer.h"
#include "softpoint/core/near_colliders.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Hands forces of the cloth on to the colliders: within a frame to those that they move, at its end to the
// rest, so that all of them can be read and sleep knows what the cloth lies on.
class ColliderCoupling {
 public:
  // Which points may push something that moves.
  void begin(const NearColliders& near, std::span<const PointContacts> contacts);
  bool any() const { return any_movable_; }
  // After a small step of `h`: contact forces (N) at the present positions, on movable colliders only.
  void push(NearColliders& near, double h, std::span<const PointContacts> contacts, const ClothSolver& solver,
            std::span<const Vec3> positions);
  // Forces (N) over `time` (s) at points (m), on the colliders given; -1: none. Movable ones, or the others.
  static void push(NearColliders& near, double time, std::span<const int> colliders,
                   std::span<const Vec3> forces, std::span<const Vec3> points, bool movable);
  // The force on a point with two planes, shared out between them.
  static void split(const PointContacts& contacts, const Vec3& force, Vec3 (&parts)[2]);

 private:
  bool any_movable_ = false;
  std::vector<int> points_;  // that have a plane of a movable collider
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
