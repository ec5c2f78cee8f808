#pragma once

#include "articulated-inl.h"
#include "lane_body.h"

// The walks of a forward dynamics for packs: equations (35) to (37) of doc/dynamics.md. Unlike the walks of a
// single figure, the accelerations that velocities cause are summed from the root outward, so that the
// inward walk multiplies no articulated inertia by them, and what the walks leave behind is small enough for
// the nearest cache.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// Where a body is and how it would move if no joint accelerated.
template <class T>
struct LanePose {
  M3<T> axes;
  V3<T> spin;   // rad/s
  V3<T> turn;   // rad/s2
  V3<T> move;   // m/s2, of its joint, less gravity
  M3<T> whirl;  // takes a point of the body to its acceleration beyond `move`
};

// Of its own, before the inward walk.
template <class T>
struct LaneWeight {
  V3<T> first;  // kg m
  S3<T> turn;   // kg m2
};
// What the joint answers, after it.
template <class T>
struct LaneAnswer {
  V6<T> reach;
  T pivot, push;
};
// What a walk leaves of one body for the next one; the halves of the union follow each other.
template <class T>
struct LaneWork {
  V3<T> axis;  // z
  V3<T> arm;
  V6<T> bias;
  union {
    LaneWeight<T> weight;
    LaneAnswer<T> answer;
  };
};
template <class T>
struct LaneBall {
  M3<T> axes;
  BallWork<T> joint;
};
template <class T>
struct LaneLoad {  // what children hand to their parent
  Inertia6<T> inertia;
  V6<T> bias;
};

// (1), (35), (36). `body` may hold packs.
template <class T, class C>
inline void lane_place(const LaneStep& step, const LaneBody<C>& body, const LanePose<T>& parent, const T* q,
                       const T* qd, LanePose<T>& to, LaneWork<T>& work, LaneBall<T>* balls) {
  LanePose<T> own;
  switch (step.turn) {
    case LaneTurn::kNone:
      own.axes = parent.axes;
      break;
    case LaneTurn::kQuarter:
      own.axes = {parent.axes.x, parent.axes.z, -parent.axes.y};
      break;
    case LaneTurn::kHalf:
      own.axes = {parent.axes.x, -parent.axes.y, -parent.axes.z};
      break;
    case LaneTurn::kAboutX: {
      const V3<T>&y = parent.axes.y, &z = parent.axes.z;
      const C &c = body.turn.y.y, &s = body.turn.y.z;
      own.axes = {parent.axes.x, y * c + z * s, z * c - y * s};
      break;
    }
    case LaneTurn::kGeneral:
      own.axes = parent.axes * body.turn;
      break;
  }
  own.spin = parent.spin;
  own.turn = parent.turn;
  own.move = parent.move;
  V3<T> arm = own.spin;  // read only where set
  if (step.armed) arm = parent.axes * body.origin;
  switch (step.joint) {
    case JointKind::kHinge: {
      T sine, cosine;
      sine_cosine(q[step.q] + body.offset, sine, cosine);
      const V3<T> x = own.axes.x, y = own.axes.y;
      own.axes.x = x * cosine + y * sine;
      own.axes.y = y * cosine - x * sine;
      const V3<T> rate = own.axes.z * qd[step.v];
      own.turn = own.turn + cross(parent.spin, rate);
      own.spin = own.spin + rate;
      break;
    }
    case JointKind::kPrismatic:
      arm = arm + own.axes.z * q[step.q];
      own.move = own.move + cross(parent.spin, own.axes.z) * (2.0 * qd[step.v]);
      break;
    case JointKind::kBall: {
      own.axes = own.axes * axes_of_quaternion(q + step.q);
      const V3<T> rate = own.axes * V3<T>{qd[step.v], qd[step.v + 1], qd[step.v + 2]};
      own.turn = own.turn + cross(parent.spin, rate);
      own.spin = own.spin + rate;
      balls[step.ball].axes = own.axes;
      break;
    }
    case JointKind::kFree:
      own.axes = axes_of_quaternion(q + step.q + 3);
      own.spin = {qd[step.v], qd[step.v + 1], qd[step.v + 2]};
      break;
    case JointKind::kFixed:
      break;
  }
  work.axis = own.axes.z;
  if (step.armed) {
    work.arm = arm;
    own.move = own.move + parent.whirl * arm;
  }
  if (step.whirls) {
    const V3<T>&w = own.spin, &a = own.turn;
    const T xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z;
    const T xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
    own.whirl = {
        {-(yy + zz), xy + a.z, xz - a.y}, {xy - a.z, -(xx + zz), yz + a.x}, {xz + a.y, yz - a.x, -(xx + yy)}};
  }
  if (step.massive) {
    const V3<T> c = own.axes * body.first_moment;
    const S3<T> turn = rotated(own.axes, body.inertia);
    work.weight.first = c;
    work.weight.turn = turn;
    work.bias.turn = turn * own.turn + cross(own.spin, turn * own.spin) + cross(c, own.move);
    work.bias.move = own.move * body.mass + own.whirl * c;
  }
  to = own;
}

// Inertia and bias of the body with all that hangs on it in `load`, which its joint then lessens.
template <class T, class C>
inline void lane_gather(const LaneStep& step, const LaneBody<C>& body, const LaneWork<T>& work,
                        LaneLoad<T>& load) {
  if (!step.massive) {
    if (!step.leaf) return;
    const T zero = work.axis.x * 0.0;
    const V3<T> none{zero, zero, zero};
    const S3<T> nothing{zero, zero, zero, zero, zero, zero};
    load = {{nothing, {none, none, none}, nothing}, {none, none}};
    return;
  }
  const V3<T>& c = work.weight.first;
  if (step.leaf) {
    const T zero = c.x * 0.0;
    const T m = zero + body.mass;
    load.inertia.turn = work.weight.turn;
    load.inertia.couple = {{zero, c.z, -c.y}, {-c.z, zero, c.x}, {c.y, -c.x, zero}};
    load.inertia.move = {m, zero, zero, m, zero, m};
    load.bias = work.bias;
    return;
  }
  load.inertia.turn = load.inertia.turn + work.weight.turn;
  M3<T>& h = load.inertia.couple;
  h.x.y += c.z;
  h.x.z -= c.y;
  h.y.x -= c.z;
  h.y.z += c.x;
  h.z.x += c.y;
  h.z.y -= c.x;
  load.inertia.move.xx += body.mass;
  load.inertia.move.yy += body.mass;
  load.inertia.move.zz += body.mass;
  load.bias = load.bias + work.bias;
}

// (4), (37).
template <class T, class C>
inline void lane_yield(const LaneStep& step, const LaneBody<C>& body, const T* tau, const T* qd,
                       LaneWork<T>& work, LaneBall<T>* balls, LaneLoad<T>& load) {
  Inertia6<T>& i = load.inertia;
  V6<T>& p = load.bias;
  switch (step.joint) {
    case JointKind::kHinge:
    case JointKind::kPrismatic: {
      const V3<T> s = work.axis;
      V6<T> reach;
      T diagonal, push = tau[step.v];
      if (step.damped) push = push - body.damping * qd[step.v];
      if (step.joint == JointKind::kHinge) {
        reach = {i.turn * s, transposed_times(i.couple, s)};
        diagonal = dot(s, reach.turn);
        push = push - dot(s, p.turn);
      } else {
        reach = {i.couple * s, i.move * s};
        diagonal = dot(s, reach.move);
        push = push - dot(s, p.move);
      }
      const T least = (i.turn.xx + i.turn.yy + i.turn.zz + i.move.xx) * kSmallestPivot;
      const T pivot = 1.0 / (diagonal + least + body.armature);
      work.answer.reach = reach;
      work.answer.pivot = pivot;
      work.answer.push = push;
      const V6<T> scaled{reach.turn * pivot, reach.move * pivot};
      p.turn = p.turn + scaled.turn * push;
      p.move = p.move + scaled.move * push;
      subtract_outer(i.turn, reach.turn, scaled.turn);
      subtract_outer(i.move, reach.move, scaled.move);
      i.couple.x = i.couple.x - scaled.turn * reach.move.x;
      i.couple.y = i.couple.y - scaled.turn * reach.move.y;
      i.couple.z = i.couple.z - scaled.turn * reach.move.z;
      break;
    }
    case JointKind::kBall: {  // as yield() has it
      BallWork<T>& ball = balls[step.ball].joint;
      const T armature = ball.armature = (i.turn.xx + i.turn.yy + i.turn.zz) * kSmallestPivot + body.armature;
      S3<T> diagonal = i.turn;
      diagonal.xx += armature;
      diagonal.yy += armature;
      diagonal.zz += armature;
      ball.pivot = inverse(diagonal);
      V3<T> torque{tau[step.v], tau[step.v + 1], tau[step.v + 2]};
      if (step.damped) torque = torque - V3<T>{qd[step.v], qd[step.v + 1], qd[step.v + 2]} * body.damping;
      torque = balls[step.ball].axes * torque;
      ball.push = torque - p.turn;
      ball.solved = {ball.pivot * i.couple.x, ball.pivot * i.couple.y, ball.pivot * i.couple.z};
      p.turn = torque - (ball.pivot * ball.push) * armature;
      p.move = p.move + transposed_times(ball.solved, ball.push);
      leave_ball(ball, i);
      break;
    }
    case JointKind::kFree: {
      const V6<T> wrench{V3<T>{tau[step.v], tau[step.v + 1], tau[step.v + 2]} - p.turn,
                         V3<T>{tau[step.v + 3], tau[step.v + 4], tau[step.v + 5]} - p.move};
      work.answer.reach = solve_free(i, wrench);  // its acceleration
      break;
    }
    case JointKind::kFixed:
      break;
  }
}

// The same load about the point that lies at -r: see shifted(). Number by number, as the compiler copies
// whole structs of packs by slow means.
template <class T>
inline void lane_shift(const V3<T>& r, LaneLoad<T>& load) {
  const S3<T>& m = load.inertia.move;
  const V3<T> hx = load.inertia.couple.x, hy = load.inertia.couple.y, hz = load.inertia.couple.z;
  const V3<T> kx = hx + V3<T>{r.y * m.xz - r.z * m.xy, r.z * m.xx - r.x * m.xz, r.x * m.xy - r.y * m.xx};
  const V3<T> ky = hy + V3<T>{r.y * m.yz - r.z * m.yy, r.z * m.xy - r.x * m.yz, r.x * m.yy - r.y * m.xy};
  const V3<T> kz = hz + V3<T>{r.y * m.zz - r.z * m.yz, r.z * m.xz - r.x * m.zz, r.x * m.yz - r.y * m.xz};
  S3<T>& turn = load.inertia.turn;
  turn.xx = turn.xx - (hy.x * r.z - hz.x * r.y) + (r.y * kz.x - r.z * ky.x);
  turn.xy = turn.xy - (hz.x * r.x - hx.x * r.z) + (r.y * kz.y - r.z * ky.y);
  turn.xz = turn.xz - (hx.x * r.y - hy.x * r.x) + (r.y * kz.z - r.z * ky.z);
  turn.yy = turn.yy - (hz.y * r.x - hx.y * r.z) + (r.z * kx.y - r.x * kz.y);
  turn.yz = turn.yz - (hx.y * r.y - hy.y * r.x) + (r.z * kx.z - r.x * kz.z);
  turn.zz = turn.zz - (hx.z * r.y - hy.z * r.x) + (r.x * ky.z - r.y * kx.z);
  load.inertia.couple.x = kx;
  load.inertia.couple.y = ky;
  load.inertia.couple.z = kz;
  load.bias.turn = load.bias.turn + cross(r, load.bias.move);
}

// (6): what a body's parent feels of it. A child that takes over its parent's slot leaves it there.
template <class T>
inline void lane_lean(const LaneStep& step, const LaneWork<T>& work, LaneLoad<T>& load, LaneLoad<T>& parent) {
  if (step.armed) lane_shift(work.arm, load);
  if (step.over) return;
  parent.inertia += load.inertia;
  parent.bias = parent.bias + load.bias;
}

// (37), outward: `parent` and `to` are accelerations beyond those of the poses.
template <class T>
inline void lane_answer(const LaneStep& step, const LaneWork<T>& work, const LaneBall<T>* balls,
                        const V6<T>& parent, V6<T>& to, T* qdd) {
  V6<T> a = parent;
  if (step.armed) a.move = a.move + cross(a.turn, work.arm);
  switch (step.joint) {
    case JointKind::kHinge: {
      const T rate = work.answer.pivot * (work.answer.push - dot(work.answer.reach, a));
      a.turn = a.turn + work.axis * rate;
      qdd[step.v] = rate;
      break;
    }
    case JointKind::kPrismatic: {
      const T rate = work.answer.pivot * (work.answer.push - dot(work.answer.reach, a));
      a.move = a.move + work.axis * rate;
      qdd[step.v] = rate;
      break;
    }
    case JointKind::kBall: {
      const BallWork<T>& ball = balls[step.ball].joint;
      const V3<T> rate = ball.pivot * (ball.push + a.turn * ball.armature) - a.turn - ball.solved * a.move;
      a.turn = a.turn + rate;
      const V3<T> own = transposed_times(balls[step.ball].axes, rate);
      qdd[step.v] = own.x;
      qdd[step.v + 1] = own.y;
      qdd[step.v + 2] = own.z;
      break;
    }
    case JointKind::kFree:
      a = work.answer.reach;
      qdd[step.v] = a.turn.x;
      qdd[step.v + 1] = a.turn.y;
      qdd[step.v + 2] = a.turn.z;
      qdd[step.v + 3] = a.move.x;  // the pose has the world's own
      qdd[step.v + 4] = a.move.y;
      qdd[step.v + 5] = a.move.z;
      break;
    case JointKind::kFixed:
      break;
  }
  to = a;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
