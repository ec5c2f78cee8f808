#pragma once

#include "lane_math.h"
#include "sine_cosine-inl.h"
#include "tree_body.h"

// The recursions over a tree of bodies, each an O(N) walk; equations (1) to (9) of doc/dynamics.md. Axes are
// those of the world, every body's quantities are taken about its own joint, and accelerations are the
// ordinary second derivatives of position. A common origin would lose digits on long chains: m c^2 cancels.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// What the walks leave of one body.
template <class T>
struct BodyWork {
  M3<T> axes;        // the body's axes in the world's
  V3<T> arm;         // m, from the parent's joint to this one
  V3<T> spin;        // rad/s
  V3<T> joint_spin;  // rad/s, of the joint alone (hinge, ball)
  V6<T> drift;       // accelerations that the velocities alone make: (2)
  V6<T> acceleration;
  Inertia6<T> inertia;  // rigid, then articulated: (4)
  V6<T> bias;           // wrench at zero acceleration, then articulated: (5)
  V6<T> reach;          // U = I S of a joint with one degree of freedom
  T pivot;              // 1 / (S^T I S + armature)
  T push;               // u = tau - S^T p
};

// What the joint of a ball keeps besides.
template <class T>
struct BallWork {
  S3<T> pivot;   // (turn + armature)^-1
  M3<T> solved;  // pivot * couple
  V3<T> push;    // u = tau - p, world axes
  T armature;    // kg m2, as the pivot has it
};

// A pivot of a joint without any inertia behind it (chained hinges in gimbal lock) stays finite.
constexpr double kSmallestPivot = 1e-16;

// Where the parent's quantities of a root come from.
template <class T>
struct WorldFrame {
  V6<T> acceleration;  // that of the world less gravity
};

template <class T>
inline M3<T> axes_of_quaternion(const T* q) {  // w, x, y, z
  const T w = q[0], x = q[1], y = q[2], z = q[3];
  const T one = w * w + x * x + y * y + z * z;
  return {{one - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)},
          {2.0 * (x * y - w * z), one - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)},
          {2.0 * (x * z + w * y), 2.0 * (y * z - w * x), one - 2.0 * (x * x + y * y)}};
}

// (1), (2): pose and spin of a body from those of its parent (null: the world), and the accelerations its
// velocities cause.
template <class T>
inline void place_body(const TreeBody& body, const BodyWork<T>* parent, const T* q, const T* qd,
                       BodyWork<T>& work) {
  const T zero = q[0] * 0.0;
  const V3<T> none{zero, zero, zero};
  if (parent == nullptr) {
    const V3<T> x{zero + 1.0, zero, zero}, y{zero, zero + 1.0, zero}, z{zero, zero, zero + 1.0};
    work.axes = M3<T>{x, y, z} * body.turn;
    work.arm = {zero + body.origin.x, zero + body.origin.y, zero + body.origin.z};
    work.spin = none;
    work.drift = {none, none};
  } else {
    work.axes = parent->axes * body.turn;
    work.arm = none;
    if (body.armed) work.arm = parent->axes * body.origin;
    work.spin = parent->spin;
    work.drift.turn = none;
  }
  work.joint_spin = none;
  switch (body.joint) {
    case JointKind::kHinge: {
      T sine, cosine;
      sine_cosine(q[body.q], sine, cosine);
      const V3<T> x = work.axes.x, y = work.axes.y;
      work.axes.x = x * cosine + y * sine;
      work.axes.y = y * cosine - x * sine;
      work.joint_spin = work.axes.z * qd[body.v];
      break;
    }
    case JointKind::kPrismatic:
      work.arm = work.arm + work.axes.z * q[body.q];
      break;
    case JointKind::kBall:
      work.axes = work.axes * axes_of_quaternion(q + body.q);
      work.joint_spin = work.axes * V3<T>{qd[body.v], qd[body.v + 1], qd[body.v + 2]};
      break;
    case JointKind::kFree:
      work.arm = work.arm + V3<T>{q[body.q], q[body.q + 1], q[body.q + 2]};
      work.axes = axes_of_quaternion(q + body.q + 3);
      work.joint_spin = {qd[body.v], qd[body.v + 1], qd[body.v + 2]};
      break;
    case JointKind::kFixed:
      break;
  }
  if (parent != nullptr) {
    const V3<T>& spin = parent->spin;
    work.drift.turn = cross(spin, work.joint_spin);
    work.drift.move = none;
    if (body.armed) work.drift.move = cross(spin, cross(spin, work.arm));
    if (body.joint == JointKind::kPrismatic) {
      work.drift.move = work.drift.move + cross(spin, work.axes.z) * (2.0 * qd[body.v]);
    }
  }
  work.spin = work.spin + work.joint_spin;
}

// (3): inertia of the body itself and the wrench its spin needs.
template <class T>
inline void weigh(const TreeBody& body, BodyWork<T>& work) {
  const T zero = work.spin.x * 0.0;
  if (body.massless) {
    const V3<T> none{zero, zero, zero};
    work.inertia = {
        {zero, zero, zero, zero, zero, zero}, {none, none, none}, {zero, zero, zero, zero, zero, zero}};
    work.bias = {none, none};
    return;
  }
  const V3<T> c = work.axes * body.first_moment;
  const T m = zero + body.mass;
  work.inertia.turn = rotated(work.axes, body.inertia);
  // The couple is the skew matrix [m c]: columns e_x x ..., that is (0, c.z, -c.y), ...
  work.inertia.couple = {{zero, c.z, -c.y}, {-c.z, zero, c.x}, {c.y, -c.x, zero}};
  work.inertia.move = {m, zero, zero, m, zero, m};
  work.bias.turn = cross(work.spin, work.inertia.turn * work.spin);
  work.bias.move = cross(work.spin, cross(work.spin, c));
}

// Acceleration that a child of `parent` would have if its joint did not accelerate.
template <class T>
inline V6<T> carried(const V6<T>& parent, const BodyWork<T>& work) {
  return {parent.turn + work.drift.turn, parent.move + cross(parent.turn, work.arm) + work.drift.move};
}

// Adds S qdd.
template <class T>
inline void accelerate(const TreeBody& body, const BodyWork<T>& work, const T* qdd, V6<T>& acceleration) {
  switch (body.joint) {
    case JointKind::kHinge:
      acceleration.turn = acceleration.turn + work.axes.z * qdd[body.v];
      break;
    case JointKind::kPrismatic:
      acceleration.move = acceleration.move + work.axes.z * qdd[body.v];
      break;
    case JointKind::kBall:
      acceleration.turn =
          acceleration.turn + work.axes * V3<T>{qdd[body.v], qdd[body.v + 1], qdd[body.v + 2]};
      break;
    case JointKind::kFree:
      acceleration.turn = acceleration.turn + V3<T>{qdd[body.v], qdd[body.v + 1], qdd[body.v + 2]};
      acceleration.move = acceleration.move + V3<T>{qdd[body.v + 3], qdd[body.v + 4], qdd[body.v + 5]};
      break;
    case JointKind::kFixed:
      break;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
