#pragma once

#include "softpoint/core/config.h"

// Small vectors and matrices over a scalar T: double, or a pack whose lanes are the figures of a crowd. One
// source serves both, so there are no branches on values here.
//
// Kernels built for other instruction sets include this header: it must hold nothing of the standard library.
namespace softpoint::inline SOFTPOINT_ABI::figure {

template <class T>
struct V3 {
  T x, y, z;
};

template <class T>
inline V3<T> operator+(const V3<T>& a, const V3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T>
inline V3<T> operator-(const V3<T>& a, const V3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T>
inline V3<T> operator-(const V3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T, class S>
inline V3<T> operator*(const V3<T>& a, const S& s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class T>
inline T dot(const V3<T>& a, const V3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
inline V3<T> cross(const V3<T>& a, const V3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Columns x, y, z.
template <class T>
struct M3 {
  V3<T> x, y, z;
};

// A constant of the model (plain doubles) on the right, so that packs need no copies of it.
template <class T, class S>
inline V3<T> operator*(const M3<T>& m, const V3<S>& v) {
  return {m.x.x * v.x + m.y.x * v.y + m.z.x * v.z, m.x.y * v.x + m.y.y * v.y + m.z.y * v.z,
          m.x.z * v.x + m.y.z * v.y + m.z.z * v.z};
}
template <class T, class S>
inline M3<T> operator*(const M3<T>& a, const M3<S>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
// m^T v
template <class T>
inline V3<T> transposed_times(const M3<T>& m, const V3<T>& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}

// Symmetric.
template <class T>
struct S3 {
  T xx, xy, xz, yy, yz, zz;
};

template <class T>
inline S3<T> operator+(const S3<T>& a, const S3<T>& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
template <class T>
inline V3<T> operator*(const S3<T>& s, const V3<T>& v) {
  return {s.xx * v.x + s.xy * v.y + s.xz * v.z, s.xy * v.x + s.yy * v.y + s.yz * v.z,
          s.xz * v.x + s.yz * v.y + s.zz * v.z};
}
// r s r^T
template <class T, class S>
inline S3<T> rotated(const M3<T>& r, const S3<S>& s) {
  const V3<T> a = r.x * s.xx + r.y * s.xy + r.z * s.xz;
  const V3<T> b = r.x * s.xy + r.y * s.yy + r.z * s.yz;
  const V3<T> c = r.x * s.xz + r.y * s.yz + r.z * s.zz;
  return {a.x * r.x.x + b.x * r.y.x + c.x * r.z.x, a.x * r.x.y + b.x * r.y.y + c.x * r.z.y,
          a.x * r.x.z + b.x * r.y.z + c.x * r.z.z, a.y * r.x.y + b.y * r.y.y + c.y * r.z.y,
          a.y * r.x.z + b.y * r.y.z + c.y * r.z.z, a.z * r.x.z + b.z * r.y.z + c.z * r.z.z};
}
// s - a b^T where a and b are parallel, so that the product is symmetric
template <class T>
inline void subtract_outer(S3<T>& s, const V3<T>& a, const V3<T>& b) {
  s.xx -= a.x * b.x;
  s.xy -= a.x * b.y;
  s.xz -= a.x * b.z;
  s.yy -= a.y * b.y;
  s.yz -= a.y * b.z;
  s.zz -= a.z * b.z;
}

// Rigid or articulated inertia about a point, world axes: it takes the angular and linear acceleration
// (alpha, a) of that point to moment and force there,
//   [moment]   [ turn      couple ] [alpha]
//   [force ] = [ couple^T  move   ] [  a  ].
template <class T>
struct Inertia6 {
  S3<T> turn;    // kg m2
  M3<T> couple;  // kg m
  S3<T> move;    // kg
};

// Moment and force, or angular and linear.
template <class T>
struct V6 {
  V3<T> turn, move;
};

template <class T>
inline V6<T> operator+(const V6<T>& a, const V6<T>& b) {
  return {a.turn + b.turn, a.move + b.move};
}
template <class T>
inline V6<T> operator-(const V6<T>& a, const V6<T>& b) {
  return {a.turn - b.turn, a.move - b.move};
}
template <class T>
inline T dot(const V6<T>& a, const V6<T>& b) {
  return dot(a.turn, b.turn) + dot(a.move, b.move);
}
template <class T>
inline V6<T> operator*(const Inertia6<T>& i, const V6<T>& v) {
  return {i.turn * v.turn + i.couple * v.move, transposed_times(i.couple, v.turn) + i.move * v.move};
}
template <class T>
inline void operator+=(Inertia6<T>& a, const Inertia6<T>& b) {
  a.turn = a.turn + b.turn;
  a.couple = {a.couple.x + b.couple.x, a.couple.y + b.couple.y, a.couple.z + b.couple.z};
  a.move = a.move + b.move;
}

// The same inertia about the point that lies at -r: with the skew matrix [r],
//   couple' = couple + [r] move,   turn' = turn - couple [r] + [r] couple'^T.
template <class T>
inline Inertia6<T> shifted(const Inertia6<T>& i, const V3<T>& r) {
  Inertia6<T> result;
  result.move = i.move;
  const M3<T>& h = i.couple;
  const S3<T>& m = i.move;
  M3<T>& k = result.couple;
  k.x = h.x + V3<T>{r.y * m.xz - r.z * m.xy, r.z * m.xx - r.x * m.xz, r.x * m.xy - r.y * m.xx};
  k.y = h.y + V3<T>{r.y * m.yz - r.z * m.yy, r.z * m.xy - r.x * m.yz, r.x * m.yy - r.y * m.xy};
  k.z = h.z + V3<T>{r.y * m.zz - r.z * m.yz, r.z * m.xz - r.x * m.zz, r.x * m.yz - r.y * m.xz};
  // (h [r]) has the columns h.y r.z - h.z r.y, h.z r.x - h.x r.z, h.x r.y - h.y r.x;
  // ([r] k^T)_ab = (r x row_b of k)_a.
  result.turn.xx = i.turn.xx - (h.y.x * r.z - h.z.x * r.y) + (r.y * k.z.x - r.z * k.y.x);
  result.turn.xy = i.turn.xy - (h.z.x * r.x - h.x.x * r.z) + (r.y * k.z.y - r.z * k.y.y);
  result.turn.xz = i.turn.xz - (h.x.x * r.y - h.y.x * r.x) + (r.y * k.z.z - r.z * k.y.z);
  result.turn.yy = i.turn.yy - (h.z.y * r.x - h.x.y * r.z) + (r.z * k.x.y - r.x * k.z.y);
  result.turn.yz = i.turn.yz - (h.x.y * r.y - h.y.y * r.x) + (r.z * k.x.z - r.x * k.z.z);
  result.turn.zz = i.turn.zz - (h.x.z * r.y - h.y.z * r.x) + (r.x * k.y.z - r.y * k.x.z);
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
