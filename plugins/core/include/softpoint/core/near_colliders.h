#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <memory>
#include <span>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The surface of a collider as a point near it sees it.
struct NearSurface {
  double gap = 0;               // m, from the surface to the point; negative inside
  Vec3 normal = Vec3::UnitY();  // outward unit, world frame
};

// A point that a handle or an anchor holds, for a deformable that solves its own contact.
struct HeldPoint {
  long long handle = 0;         // HandleId
  int point = 0;                // of the deformable
  Vec3 target = Vec3::Zero();   // m, for the end of the step: in the world, or in the collider's frame
  double max_force = 0;         // N, may be infinite
  int collider = -1;            // it is tied to; -1: the world
  Vec3 impulse = Vec3::Zero();  // N s on the deformable over the step: filled in by it
};

// What is near a deformable that solves its own contact (Deformable::solves_contact), during one step: every
// collision object that the broadphase and the app's filters let through, taken apart into pieces of one
// shape each. Colliders begin where the step begins; advance() moves them on by the velocities they have
// then, which push() changes. What Bullet's solver has found for the step is in those velocities; of the load
// that the deformable carried over from the last step (so that Bullet could answer it), advance() takes back
// as much as belongs to the time it covers.
class SOFTPOINT_API NearColliders {
 public:
  struct Collider {
    const btCollisionObject* object = nullptr;
    bool movable = false;  // impulses move it
    double friction = 0;   // of it and the deformable, as Bullet combines them
  };
  struct Piece {
    int collider = 0;
    int child = 0;        // of a compound, counted over all levels
    bool plane = false;   // unbounded
    bool mesh = false;    // triangles without an inside
    double thinnest = 0;  // m, smallest distance across
  };

  int colliders() const;
  const Collider& collider(int index) const;
  int pieces() const;
  const Piece& piece(int index) const;

  // Where a collider is now and how it moves.
  Vec3 center(int collider) const;                       // m, centre of mass
  Vec3 to_world(int collider, const Vec3& local) const;  // of a point of the object's own frame
  Vec3 to_local(int collider, const Vec3& point) const;
  Vec3 velocity(int collider) const;                        // m/s, of the centre of mass
  Vec3 spin(int collider) const;                            // rad/s
  Vec3 velocity_at(int collider, const Vec3& point) const;  // m/s, of its material at `point`
  // Column-major 6x6: change of (velocity, spin) per impulse (N s) and moment (N m s) about the centre of
  // mass. Zero for what impulses do not move.
  void mobility(int collider, double* block) const;
  // Impulse (N s) on a collider at a point (m), and a moment (N m s) beside it.
  void push(int collider, const Vec3& impulse, const Vec3& point);
  void push(int collider, const Vec3& impulse, const Vec3& point, const Vec3& moment);
  // What is taken back within `dt` of the step: to be called before the push that replaces it.
  void begin(double dt);
  // Lets rigid contacts under the colliders answer, then moves everything on by `dt` (s).
  void advance(double dt);

  // The surface of a piece nearest to a point, both in the world as it is now; false when it is farther than
  // `reach` (m, on both sides of a mesh, outside of everything else). Of a mesh, `side` tells on which side
  // of it the point belongs, 1 front, -1 back; 0 is replaced by the side on which it lies.
  bool nearest(int piece, const Vec3& point, double reach, signed char& side, NearSurface& surface) const;
  // Of a mesh: room for the side of each point, kept from step to step while the mesh stays near; else empty.
  std::span<signed char> sides(int piece) const;
  // Indices (ascending) of the points that may be within `reach` of a piece: a box test.
  void candidates(int piece, std::span<const Vec3> points, double reach, std::vector<int>& out) const;
  // Plane normal . x = offset of a piece that is one.
  void plane(int piece, Vec3& normal, double& offset) const;

  struct Impl;
  __attribute__((visibility("hidden"))) explicit NearColliders(std::unique_ptr<Impl> impl);
  ~NearColliders();
  NearColliders(const NearColliders&) = delete;
  NearColliders& operator=(const NearColliders&) = delete;
  Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
