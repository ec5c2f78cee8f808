#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Where two features of a cloth are nearest each other: point x[0] and face x[1], x[2], x[3], or edge x[0],
// x[1] and edge x[2], x[3].
struct Nearest {
  double weights[4] = {0, 0, 0, 0};  // of the first feature's nearest point less the second's: sum to zero
  Vec3 apart = Vec3::Zero();         // m, from the second's to the first's
  double distance = 0;               // m

  double gap(const Vec3 (&x)[4], const Vec3& along) const {
    return along.dot(weights[0] * x[0] + weights[1] * x[1] + weights[2] * x[2] + weights[3] * x[3]);
  }
};

inline void measure(Nearest& nearest, const Vec3 (&x)[4]) {
  const double* w = nearest.weights;
  nearest.apart = w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3];
  nearest.distance = nearest.apart.norm();
}

// By the regions of the face: its corners, its edges, its inside.
inline Nearest nearest_on_face(const Vec3 (&x)[4]) {
  const Vec3 u = x[2] - x[1], v = x[3] - x[1], p = x[0] - x[1];
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), pu = p.dot(u), pv = p.dot(v);
  const double det = uu * vv - uv * uv;
  // Barycentric coordinates of the foot in the plane, times det.
  const double s = pu * vv - pv * uv, t = pv * uu - pu * uv;
  double a = 0, b = 0;  // of x[2] and x[3]
  if (det > 1e-14 * uu * vv && s >= 0 && t >= 0 && s + t <= det) {
    a = s / det, b = t / det;
  } else {
    // The nearest point of the border.
    double best = HUGE_VAL;
    const auto along = [&](double from_a, double from_b, double to_a, double to_b) {
      const Vec3 from = from_a * u + from_b * v, way = (to_a - from_a) * u + (to_b - from_b) * v;
      const double part = std::clamp((p - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
      const double square = (p - from - part * way).squaredNorm();
      if (square < best) {
        best = square;
        a = from_a + part * (to_a - from_a);
        b = from_b + part * (to_b - from_b);
      }
    };
    along(0, 0, 1, 0);
    along(0, 0, 0, 1);
    along(1, 0, 0, 1);
  }
  Nearest nearest;
  nearest.weights[0] = 1;
  nearest.weights[1] = a + b - 1;
  nearest.weights[2] = -a;
  nearest.weights[3] = -b;
  measure(nearest, x);
  return nearest;
}

inline Nearest nearest_of_edges(const Vec3 (&x)[4]) {
  const Vec3 u = x[1] - x[0], w = x[3] - x[2], r = x[0] - x[2];
  const double uu = std::max(u.squaredNorm(), 1e-300), ww = std::max(w.squaredNorm(), 1e-300);
  const double uw = u.dot(w), ur = u.dot(r), wr = w.dot(r), det = uu * ww - uw * uw;
  double s = det > 1e-12 * uu * ww ? std::clamp((uw * wr - ur * ww) / det, 0.0, 1.0) : 0.0;
  double t = (uw * s + wr) / ww;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0, 1.0);
    s = std::clamp((uw * t - ur) / uu, 0.0, 1.0);
  }
  Nearest nearest;
  nearest.weights[0] = 1 - s;
  nearest.weights[1] = s;
  nearest.weights[2] = t - 1;
  nearest.weights[3] = -t;
  measure(nearest, x);
  return nearest;
}

inline Nearest nearest_of(bool edges, const Vec3 (&x)[4]) {
  return edges ? nearest_of_edges(x) : nearest_on_face(x);
}

// Whether two features stay `least` apart while their corners move straight by `ways`: they advance by what
// their distance and their speed permit at once, until the end or too near (additive conservative
// advancement, Li et al. 2021).
inline bool stay_apart(bool edges, Vec3 (&x)[4], const Vec3 (&ways)[4], double least) {
  const Vec3 shared = 0.25 * (ways[0] + ways[1] + ways[2] + ways[3]);
  double own[4];
  for (int k = 0; k < 4; ++k) own[k] = (ways[k] - shared).norm();
  const double speed = edges ? std::max(own[0], own[1]) + std::max(own[2], own[3])
                             : own[0] + std::max({own[1], own[2], own[3]});
  double time = 0;
  for (int round = 0; round < 40; ++round) {
    const double room = nearest_of(edges, x).distance - 0.9 * least;
    if (!(room > 0.1 * least)) return false;
    const double step = room / std::max(speed, 1e-300);
    if (time + step >= 1) return true;
    time += step;
    for (int k = 0; k < 4; ++k) x[k] += step * ways[k];
  }
  return false;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
