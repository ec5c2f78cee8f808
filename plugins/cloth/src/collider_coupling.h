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
  explicit ColliderCoupling(const ClothPattern& pattern);

  // What a small step left, to be corrected in place.
  struct Points {
    std::span<Vec3> positions;        // m
    std::span<Vec3> velocities;       // m/s
    std::span<const double> masses;   // kg
    std::span<const Spring> springs;  // as they are now, wet or dry
    std::span<const PointContacts> contacts;
    std::span<const ClothHand> hands;
  };
  // The air of a small step as colliders feel it.
  struct Air {
    std::span<const Vec3> foot_forces;  // N, one a point; empty: none
    std::span<const Vec3> feet;         // m, world
    std::span<const int> colliders;     // of the feet
    std::span<const int> face_pockets;
    std::span<const Triangle> faces;
    std::span<const AirPocket> pockets;
    std::span<const PocketState> states;
    Vec3 origin = Vec3::Zero();  // m, world, of the volumes
  };

  // Which points may push something that moves.
  void begin(const NearColliders& near, std::span<const PointContacts> contacts);
  bool any() const { return any_movable_; }
  // After a small step of `h`: each movable collider and the points that lie on it, moved together to where
  // their forces are in balance, the springs to other points and the air between them counted as they give
  // way. An explicit push would throw what is lighter than the cloth about. Returns whether points have
  // moved.
  bool balance(NearColliders& near, double h, const ClothSolver& solver, const Points& points,
               const Air& air);
  // Forces (N) over `time` (s) at points (m), on the immovable colliders given; -1: none.
  static void push(NearColliders& near, double time, std::span<const int> colliders,
                   std::span<const Vec3> forces, std::span<const Vec3> points);
  // The force on a point with two planes, shared out between them.
  static void split(const PointContacts& contacts, const Vec3& force, Vec3 (&parts)[2]);

 private:
  // How a point moves with its collider: all along, or along the normal only where it slides.
  struct Rider {
    int point = 0;
    bool slides = false;
    Vec3 normal = Vec3::Zero();
    Vec3 force = Vec3::Zero();  // N, on the point
  };
  bool balance_one(int collider, NearColliders& near, double h, const ClothSolver& solver,
                   const Points& points, const Air& air);
  void collect_riders(int collider, const ClothSolver& solver, const Points& points);

  bool any_movable_ = false;
  std::vector<int> points_;  // that have a plane of a movable collider
  std::vector<Rider> riders_;
  std::vector<char> rides_;        // per point
  std::vector<int> spring_begin_;  // per point, into spring_list_
  std::vector<int> spring_list_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
