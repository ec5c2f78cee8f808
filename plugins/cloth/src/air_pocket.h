#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// A volume of air as the stepper needs it for one frame. Its volume is
//
//   V = side * (sum of its faces' cones from the origin + its rim quads + closure),
//
// the cone of a face being det(a, b, c)/6. Feet, and with them `closure`, stand still within a frame.
struct AirPocket {
  double air = 0;      // K = p V, J
  double closure = 0;  // m3, the cones of the faces' shadows on the collider, reversed
  double side = 1;     // 1: the air lies behind the faces, -1: in front of them
  double max_suction = std::numeric_limits<double>::infinity();  // Pa; p >= ambient - max_suction
  double min_pressure = 0;                                       // Pa; p >= min_pressure
  double ambient = 101325;                                       // Pa
  double max_gauge = std::numeric_limits<double>::infinity();    // Pa; p <= ambient + max_gauge
  bool open = false;                                             // p = ambient: nothing to solve
};

// Closes a pocket between an edge of the cloth and its feet: the bilinear patch over a, b, foot_b, foot_a.
// The edge runs a to b along its face, so that the patch, seen from outside, runs b, a, foot_a, foot_b.
struct RimQuad {
  int pocket = -1;
  int a = -1, b = -1;
  Vec3 foot_a = Vec3::Zero(), foot_b = Vec3::Zero();  // m
};

// Cone of a triangle from the origin, m3.
inline double cone(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)) / 6; }

// Cone of the bilinear patch over p, q, r, s (in that order round it): the mean of its two triangulations,
// and linear in each corner.
inline double cone(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  return (cone(p, q, r) + cone(p, r, s) + cone(p, q, s) + cone(q, r, s)) / 2;
}

// Gradient of that cone by its corner s, m2.
inline Vec3 cone_gradient(const Vec3& p, const Vec3& q, const Vec3& r) {
  return (p.cross(q) + p.cross(r) + q.cross(r)) / 12;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
