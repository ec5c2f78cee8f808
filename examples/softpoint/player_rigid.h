#pragma once

#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <memory>
#include <vector>

#include "player_solid.h"
#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A rigid body in play. Bullet keeps a body at its centre of mass, a scene at the origin of its shape.
class RigidActor {
 public:
  // Throws Error for a shape without volume.
  explicit RigidActor(const RigidBodySpec& spec);
  RigidActor(const RigidActor&) = delete;
  RigidActor& operator=(const RigidActor&) = delete;

  btRigidBody& body() { return *body_; }
  const btRigidBody& body() const { return *body_; }
  double mass() const { return mass_; }  // kg, 0 if it never moves

  // Corners of a mesh, in the frame of the shape (m); empty for everything else.
  const std::vector<Vec3>& mesh_corners() const { return mesh_corners_; }
  Placement placement() const;

  // The convex solids it is made of (none for a mesh), and where one is now.
  std::size_t solid_count() const { return solids_.size(); }
  const ConvexSolid& solid(std::size_t k) const { return solids_[k].solid; }
  Placement solid_placement(std::size_t k) const;

 private:
  struct Part {
    ConvexSolid solid;
    Placement in_body;  // of the solid's frame in Bullet's
  };
  btCollisionShape* make_convex(const ShapeSpec& spec);
  btCollisionShape* make_mesh(const ShapeSpec& spec);
  btCollisionShape* make_shape(const RigidBodySpec& spec, Placement& body_in_shape, btVector3& inertia);
  btCollisionShape* make_compound(const RigidBodySpec& spec, Placement& body_in_shape, btVector3& inertia);

  double mass_;
  std::vector<Part> solids_;
  std::vector<Vec3> mesh_corners_;
  std::unique_ptr<btTriangleMesh> mesh_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::unique_ptr<btRigidBody> body_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
