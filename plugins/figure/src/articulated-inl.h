#pragma once

#include "placing-inl.h"

// Articulated inertias and what they answer: equations (4) to (7) of doc/dynamics.md.
namespace softpoint::inline SOFTPOINT_ABI::figure {

template <class T>
inline S3<T> inverse(const S3<T>& s) {
  const T a = s.yy * s.zz - s.yz * s.yz;
  const T b = s.xz * s.yz - s.xy * s.zz;
  const T c = s.xy * s.yz - s.xz * s.yy;
  const T scale = 1.0 / (s.xx * a + s.xy * b + s.xz * c);
  return {a * scale,
          b * scale,
          c * scale,
          (s.xx * s.zz - s.xz * s.xz) * scale,
          (s.xy * s.xz - s.xx * s.yz) * scale,
          (s.xx * s.yy - s.xy * s.xy) * scale};
}

// a^T s b, known to be symmetric
template <class T>
inline S3<T> congruent(const M3<T>& a, const M3<T>& b) {
  return {dot(a.x, b.x), dot(a.x, b.y), dot(a.x, b.z), dot(a.y, b.y), dot(a.y, b.z), dot(a.z, b.z)};
}

// What is left of the inertia `i` above a ball that yields; armature, pivot and solved are known.
template <class T>
inline void leave_ball(const BallWork<T>& ball, Inertia6<T>& i) {
  const S3<T> lost = congruent(i.couple, ball.solved);
  i.move = {i.move.xx - lost.xx, i.move.xy - lost.xy, i.move.xz - lost.xz,
            i.move.yy - lost.yy, i.move.yz - lost.yz, i.move.zz - lost.zz};
  const T armature = ball.armature, square = armature * armature;
  i.couple = {ball.solved.x * armature, ball.solved.y * armature, ball.solved.z * armature};
  // turn - turn D^-1 turn = armature (1 - armature D^-1): no difference of nearly equal matrices
  i.turn = {armature - square * ball.pivot.xx, -square * ball.pivot.xy, -square * ball.pivot.xz,
            armature - square * ball.pivot.yy, -square * ball.pivot.yz, armature - square * ball.pivot.zz};
}

// (4), (5) of a dynamic joint: what is left of the body's inertia once the joint yields. tau: its torque;
// own: its own inertia.
template <class T>
inline void yield(const TreeBody& body, double own, const T* tau, BodyWork<T>& work, BallWork<T>& ball) {
  Inertia6<T>& i = work.inertia;
  switch (body.joint) {
    case JointKind::kHinge:
    case JointKind::kPrismatic: {
      const V3<T>& s = work.axes.z;
      T diagonal;
      if (body.joint == JointKind::kHinge) {
        work.reach = {i.turn * s, transposed_times(i.couple, s)};
        diagonal = dot(s, work.reach.turn);
        work.push = tau[body.v] - dot(s, work.bias.turn);
      } else {
        work.reach = {i.couple * s, i.move * s};
        diagonal = dot(s, work.reach.move);
        work.push = tau[body.v] - dot(s, work.bias.move);
      }
      const T least = (i.turn.xx + i.turn.yy + i.turn.zz + i.move.xx) * kSmallestPivot;
      work.pivot = 1.0 / (diagonal + least + own);
      const V6<T> scaled{work.reach.turn * work.pivot, work.reach.move * work.pivot};
      const T gain = work.push - dot(work.reach, work.drift);
      work.bias = work.bias + i * work.drift + V6<T>{scaled.turn * gain, scaled.move * gain};
      subtract_outer(i.turn, work.reach.turn, scaled.turn);
      subtract_outer(i.move, work.reach.move, scaled.move);
      i.couple.x = i.couple.x - scaled.turn * work.reach.move.x;
      i.couple.y = i.couple.y - scaled.turn * work.reach.move.y;
      i.couple.z = i.couple.z - scaled.turn * work.reach.move.z;
      break;
    }
    case JointKind::kBall: {
      // In world axes S is the identity: D = turn + armature, and turn D^-1 = 1 - armature D^-1.
      const T armature = ball.armature = (i.turn.xx + i.turn.yy + i.turn.zz) * kSmallestPivot + own;
      S3<T> diagonal = i.turn;
      diagonal.xx += armature;
      diagonal.yy += armature;
      diagonal.zz += armature;
      ball.pivot = inverse(diagonal);
      ball.push = work.axes * V3<T>{tau[body.v], tau[body.v + 1], tau[body.v + 2]} - work.bias.turn;
      ball.solved = {ball.pivot * i.couple.x, ball.pivot * i.couple.y, ball.pivot * i.couple.z};
      const V6<T> moved = i * work.drift;
      const V3<T> gain = ball.pivot * (ball.push - moved.turn);
      work.bias = work.bias + moved + V6<T>{i.turn * gain, transposed_times(i.couple, gain)};
      leave_ball(ball, i);
      break;
    }
    case JointKind::kFree:
      work.bias.turn = work.bias.turn - V3<T>{tau[body.v], tau[body.v + 1], tau[body.v + 2]};
      work.bias.move = work.bias.move - V3<T>{tau[body.v + 3], tau[body.v + 4], tau[body.v + 5]};
      break;
    case JointKind::kFixed:
      break;
  }
}

// (5) of a prescribed joint: the body goes with its parent but for the given acceleration, already in
// `drift`.
template <class T>
inline void carry(BodyWork<T>& work) {
  work.bias = work.bias + work.inertia * work.drift;
}

// (6): what the parent feels of a child.
template <class T>
inline void lean(const TreeBody& body, const BodyWork<T>& child, BodyWork<T>& parent) {
  if (body.armed) {
    parent.inertia += shifted(child.inertia, child.arm);
    parent.bias.turn = parent.bias.turn + child.bias.turn + cross(child.arm, child.bias.move);
    parent.bias.move = parent.bias.move + child.bias.move;
  } else {
    parent.inertia += child.inertia;
    parent.bias = parent.bias + child.bias;
  }
}

// Symmetric 6x6 system: the acceleration at which the wrench `-bias` is all that acts. `move` is inverted
// first: a free body's mass matrix has it well conditioned.
template <class T>
inline V6<T> solve_free(const Inertia6<T>& i, const V6<T>& wrench) {
  const S3<T> move = inverse(i.move);
  const M3<T> rows{{i.couple.x.x, i.couple.y.x, i.couple.z.x},  // couple^T
                   {i.couple.x.y, i.couple.y.y, i.couple.z.y},
                   {i.couple.x.z, i.couple.y.z, i.couple.z.z}};
  const M3<T> solved{move * rows.x, move * rows.y, move * rows.z};  // move^-1 couple^T
  const S3<T> lost = congruent(rows, solved);
  const S3<T> turn = inverse(S3<T>{i.turn.xx - lost.xx, i.turn.xy - lost.xy, i.turn.xz - lost.xz,
                                   i.turn.yy - lost.yy, i.turn.yz - lost.yz, i.turn.zz - lost.zz});
  const V3<T> alpha = turn * (wrench.turn - transposed_times(solved, wrench.move));
  return {alpha, move * (wrench.move - rows * alpha)};
}

// (7): acceleration of a dynamic joint and of its body.
template <class T>
inline void answer(const TreeBody& body, const V6<T>& parent, const WorldFrame<T>& world, BodyWork<T>& work,
                   const BallWork<T>& ball, T* qdd) {
  V6<T> a = carried(parent, work);
  switch (body.joint) {
    case JointKind::kHinge: {
      const T rate = work.pivot * (work.push - dot(work.reach, a));
      a.turn = a.turn + work.axes.z * rate;
      qdd[body.v] = rate;
      break;
    }
    case JointKind::kPrismatic: {
      const T rate = work.pivot * (work.push - dot(work.reach, a));
      a.move = a.move + work.axes.z * rate;
      qdd[body.v] = rate;
      break;
    }
    case JointKind::kBall: {
      const V3<T> rate = ball.pivot * (ball.push + a.turn * ball.armature) - a.turn - ball.solved * a.move;
      a.turn = a.turn + rate;
      const V3<T> own = transposed_times(work.axes, rate);
      qdd[body.v] = own.x;
      qdd[body.v + 1] = own.y;
      qdd[body.v + 2] = own.z;
      break;
    }
    case JointKind::kFree:
      a = solve_free(work.inertia, V6<T>{-work.bias.turn, -work.bias.move});
      qdd[body.v] = a.turn.x;
      qdd[body.v + 1] = a.turn.y;
      qdd[body.v + 2] = a.turn.z;
      qdd[body.v + 3] = a.move.x - world.acceleration.move.x;
      qdd[body.v + 4] = a.move.y - world.acceleration.move.y;
      qdd[body.v + 5] = a.move.z - world.acceleration.move.z;
      break;
    case JointKind::kFixed:
      break;
  }
  work.acceleration = a;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
