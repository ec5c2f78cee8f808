#pragma once

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <span>
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

  // Impulse (N s) on an object at `arm` (m) from its centre of mass. Changes the velocities of every object
  // that is joined to it. Nothing when the object is not movable.
  void push(int index, const Vec3& impulse, const Vec3& arm);
  // The same for the free velocities, and the velocities with them.
  void push_free(int index, const Vec3& impulse, const Vec3& arm);
  // d(velocity of object a at arm_a) / d(impulse on object b at arm_b), 1/kg. Zero between objects that are
  // not joined.
  Mat3 compliance(int a, const Vec3& arm_a, int b, const Vec3& arm_b) const;
  // Calls visit(span of doubles) for everything that pushes change linearly.
  template <class Visit>
  void visit_state(Visit visit) {
    for (RigidState& state : states_) {
      if (state.movable()) {
        visit(std::span<double>(state.velocity.data(), 3));
        visit(std::span<double>(state.angular_velocity.data(), 3));
      }
    }
  }
  // All velocities back to the free ones.
  void restart();
  // End poses by the present velocities.
  void integrate(double dt);
  // Hand the changed velocities to Bullet, waking what sleeps.
  void write_back();

 private:
  std::vector<RigidState> states_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
