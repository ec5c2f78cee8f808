#pragma once

#include "articulated-inl.h"

// Further wrenches on a figure whose articulated inertias are known, and torques of joints: equation (8) of
// doc/dynamics.md.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// (8): the part of a wrench that the joint passes on to the parent, and what answer it causes. `reply` is the
// change of the bias, tau that of the joints' torques.
template <class T>
inline V6<T> passed_on(const TreeBody& body, const BodyWork<T>& work, const BallWork<T>& ball, const T* tau,
                       const V6<T>& reply) {
  switch (body.joint) {
    case JointKind::kHinge: {
      const T gain = work.pivot * (tau[body.v] - dot(work.axes.z, reply.turn));
      return {reply.turn + work.reach.turn * gain, reply.move + work.reach.move * gain};
    }
    case JointKind::kPrismatic: {
      const T gain = work.pivot * (tau[body.v] - dot(work.axes.z, reply.move));
      return {reply.turn + work.reach.turn * gain, reply.move + work.reach.move * gain};
    }
    case JointKind::kBall: {
      // turn D^-1 = 1 - armature D^-1
      const V3<T> torque = work.axes * V3<T>{tau[body.v], tau[body.v + 1], tau[body.v + 2]};
      const V3<T> push = torque - reply.turn;
      return {torque - (ball.pivot * push) * ball.armature, reply.move + transposed_times(ball.solved, push)};
    }
    case JointKind::kFree:
    case JointKind::kFixed:
      break;
  }
  return reply;
}

// (8), outward: change of the acceleration of joint and body, from that of the parent already carried to the
// body.
template <class T>
inline V6<T> replied(const TreeBody& body, const BodyWork<T>& work, const BallWork<T>& ball, const T* tau,
                     const V6<T>& reply, V6<T> a, T* change) {
  switch (body.joint) {
    case JointKind::kHinge: {
      const T rate = work.pivot * (tau[body.v] - dot(work.axes.z, reply.turn) - dot(work.reach, a));
      a.turn = a.turn + work.axes.z * rate;
      change[body.v] = rate;
      break;
    }
    case JointKind::kPrismatic: {
      const T rate = work.pivot * (tau[body.v] - dot(work.axes.z, reply.move) - dot(work.reach, a));
      a.move = a.move + work.axes.z * rate;
      change[body.v] = rate;
      break;
    }
    case JointKind::kBall: {
      const V3<T> push = work.axes * V3<T>{tau[body.v], tau[body.v + 1], tau[body.v + 2]} - reply.turn;
      const V3<T> rate = ball.pivot * (push + a.turn * ball.armature) - a.turn - ball.solved * a.move;
      a.turn = a.turn + rate;
      const V3<T> own = transposed_times(work.axes, rate);
      change[body.v] = own.x;
      change[body.v + 1] = own.y;
      change[body.v + 2] = own.z;
      break;
    }
    case JointKind::kFree: {
      a = solve_free(work.inertia,
                     V6<T>{V3<T>{tau[body.v], tau[body.v + 1], tau[body.v + 2]} - reply.turn,
                           V3<T>{tau[body.v + 3], tau[body.v + 4], tau[body.v + 5]} - reply.move});
      change[body.v] = a.turn.x;
      change[body.v + 1] = a.turn.y;
      change[body.v + 2] = a.turn.z;
      change[body.v + 3] = a.move.x;
      change[body.v + 4] = a.move.y;
      change[body.v + 5] = a.move.z;
      break;
    }
    case JointKind::kFixed:
      break;
  }
  return a;
}

// S^T of a wrench.
template <class T>
inline void take_torque(const TreeBody& body, const BodyWork<T>& work, const V6<T>& wrench, T* tau) {
  switch (body.joint) {
    case JointKind::kHinge:
      tau[body.v] = dot(work.axes.z, wrench.turn);
      break;
    case JointKind::kPrismatic:
      tau[body.v] = dot(work.axes.z, wrench.move);
      break;
    case JointKind::kFree:
      tau[body.v + 3] = wrench.move.x;
      tau[body.v + 4] = wrench.move.y;
      tau[body.v + 5] = wrench.move.z;
      tau[body.v] = wrench.turn.x;
      tau[body.v + 1] = wrench.turn.y;
      tau[body.v + 2] = wrench.turn.z;
      break;
    case JointKind::kBall: {
      const V3<T> own = transposed_times(work.axes, wrench.turn);
      tau[body.v] = own.x;
      tau[body.v + 1] = own.y;
      tau[body.v + 2] = own.z;
      break;
    }
    case JointKind::kFixed:
      break;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
