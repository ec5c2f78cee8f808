#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <unordered_map>
#include <vector>

#include "bullet_math.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Double-precision view of one collision object during one substep: where it starts, how it moves,
// where Bullet's integrator will put it.
struct RigidState {
  const btCollisionObject* object = nullptr;
  btRigidBody* body = nullptr;           // null when impulses do not move it (static, kinematic, other kinds)
  Pose start, end;                       // origin is the centre of mass
  Vec3 velocity = Vec3::Zero();          // m/s, of the centre of mass
  Vec3 angular_velocity = Vec3::Zero();  // rad/s
  Vec3 free_velocity = Vec3::Zero();     // the two above before our impulses
  Vec3 free_angular_velocity = Vec3::Zero();
  Vec3 inverse_mass = Vec3::Zero();     // 1/kg per axis (Bullet's linear factor included)
  Mat3 inverse_inertia = Mat3::Zero();  // world frame, 1/(kg m2)
  bool changed = false;

  bool movable() const { return body != nullptr; }
  Vec3 velocity_of(const Vec3& arm) const { return velocity + angular_velocity.cross(arm); }
  // Impulse (N s) at `arm` (m) from the centre of mass.
  void push(const Vec3& impulse, const Vec3& arm) {
    velocity += inverse_mass.cwiseProduct(impulse);
    angular_velocity += inverse_inertia * arm.cross(impulse);
  }
  // d(velocity at arm_a) / d(impulse at arm_b).
  Mat3 compliance(const Vec3& arm_a, const Vec3& arm_b) const {
    Mat3 result = -cross_matrix(arm_a) * inverse_inertia * cross_matrix(arm_b);
    result.diagonal() += inverse_mass;
    return result;
  }
  // Where btTransformUtil::integrateTransform will put the body after `dt`.
  void integrate(double dt);
};

// The colliders of one substep. Indices stay valid until clear().
class RigidStates {
 public:
  void clear();
  int find_or_add(const btCollisionObject* object, double dt);
  // Index of an object already present, or -1.
  int find(const btCollisionObject* object) const;
  RigidState& operator[](int index) { return states_[static_cast<std::size_t>(index)]; }
  const RigidState& operator[](int index) const { return states_[static_cast<std::size_t>(index)]; }
  int size() const { return static_cast<int>(states_.size()); }
  // Hand the changed velocities to Bullet, waking what sleeps.
  void write_back();

 private:
  std::vector<RigidState> states_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
