#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <vector>

#include "articulated_body.h"
#include "bullet_math.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Double-precision view of one collision object during one substep: where it starts, how it moves,
// where Bullet's integrator will put it.
struct RigidState {
  const btCollisionObject* object = nullptr;
  btRigidBody* body = nullptr;           // a rigid body that impulses move, or null
  int articulated = -1;                  // the articulated body it is a link of, or -1
  int slot = -1;                         // among the links touched there
  bool movable_link = false;             // a link that impulses move
  Pose start, end;                       // origin is the centre of mass
  Vec3 velocity = Vec3::Zero();          // m/s, of the centre of mass
  Vec3 angular_velocity = Vec3::Zero();  // rad/s
  Vec3 free_velocity = Vec3::Zero();     // the two above before our impulses
  Vec3 free_angular_velocity = Vec3::Zero();
  Vec3 inverse_mass = Vec3::Zero();     // 1/kg per axis (Bullet's linear factor included)
  Mat3 inverse_inertia = Mat3::Zero();  // world frame, 1/(kg m2)
  bool changed = false;

  bool movable() const { return body != nullptr || movable_link; }
  Vec3 velocity_of(const Vec3& arm) const { return velocity + angular_velocity.cross(arm); }
  // Where btTransformUtil::integrateTransform will put the body after `dt`.
  void integrate(double dt);
};

// The colliders of one substep. Indices stay valid until clear().
class RigidStates {
 public:
  // Multibodies step only in a btMultiBodyDynamicsWorld; elsewhere their links stand still.
  explicit RigidStates(btDiscreteDynamicsWorld& world);

  void clear();
  int find_or_add(const btCollisionObject* object, double dt);
  // Index of an object already present, or -1.
  int find(const btCollisionObject* object) const;
  RigidState& operator[](int index) { return states_[static_cast<std::size_t>(index)]; }
  const RigidState& operator[](int index) const { return states_[static_cast<std::size_t>(index)]; }
  int size() const { return static_cast<int>(states_.size()); }

  // Impulse (N s) on an object at `arm` (m) from its centre of mass. Changes the velocities of every object
  // that is joined to it. Nothing when the object is not movable.
  void push(int index, const Vec3& impulse, const Vec3& arm);
  // The same by its moment (N m s) about the centre of mass.
  void push_wrench(int index, const Vec3& impulse, const Vec3& moment);
  // The same for the free velocities, and the velocities with them.
  void push_free(int index, const Vec3& impulse, const Vec3& arm);
  // d(velocity of object a at arm_a) / d(impulse on object b at arm_b), 1/kg. Zero between objects that are
  // not joined.
  Mat3 compliance(int a, const Vec3& arm_a, int b, const Vec3& arm_b) const;
  // Column-major 6x6: change of (velocity, angular velocity) of an object per impulse and moment on it.
  void mobility(int index, double* block) const;
  // Whether pushes on one change the velocities of the other.
  bool joined(int a, int b) const;
  // All velocities back to the free ones.
  void restart();
  // End poses by the present velocities.
  void integrate(double dt);
  // World position (m) of a point of an object's frame at the end of the step, by the present velocities.
  Vec3 end_point(int index, const Vec3& local, double dt) const;
  // Hands the changed velocities to Bullet, after its constraint solver has run, waking what sleeps.
  void write_back();
  // The same at the begin of a step of `dt`, before its solver has run unless `solved`; take_back() undoes
  // what of it would last.
  void load(double dt, bool solved);
  void take_back();

 private:
  bool read_link(RigidState& state, double dt);
  int find_or_add_articulated(btMultiBody& body, double dt);

  void write_back_rigid();

  btMultiBodyDynamicsWorld* multibody_world_;  // or null
  bool forces_come_first_ = false;             // the world integrates forces before it looks for collisions
  std::vector<RigidState> states_;
  struct Articulated {
    ArticulatedBody body;
    std::vector<int> states;  // of its touched links, by slot
    bool in_use = false, changed = false;
  };
  std::vector<Articulated> articulated_;  // by index in the world, so that each keeps its storage
};

}  // namespace softpoint::inline SOFTPOINT_ABI
