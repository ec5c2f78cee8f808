#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "softpoint/core/vec.h"

// Slow and obvious: the kernels of elastostatics as printed in the textbooks, and quadrature that
// converges on anything. Only the tests use these.
namespace softpoint::elastic::reference {

// Kelvin's solution: displacement at x along i for a unit force at y along j.
inline Mat3 kelvin_displacement(const Vec3& x, const Vec3& y, double mu, double nu) {
  const Vec3 r = y - x;
  const double distance = r.norm();
  const Vec3 e = r / distance;
  return ((3.0 - 4.0 * nu) * Mat3::Identity() + e * e.transpose()) /
         (16.0 * std::numbers::pi * mu * (1.0 - nu) * distance);
}

// Its traction at y on a surface of normal n.
inline Mat3 kelvin_traction(const Vec3& x, const Vec3& y, const Vec3& n, double nu) {
  const Vec3 r = y - x;
  const double distance = r.norm();
  const Vec3 e = r / distance;
  const double slope = e.dot(n);
  return -(slope * ((1.0 - 2.0 * nu) * Mat3::Identity() + 3.0 * e * e.transpose()) -
           (1.0 - 2.0 * nu) * (e * n.transpose() - n * e.transpose())) /
         (8.0 * std::numbers::pi * (1.0 - nu) * distance * distance);
}

using Corners = std::array<Vec3, 3>;

inline Vec3 normal(const Corners& v) { return (v[1] - v[0]).cross(v[2] - v[0]).normalized(); }
inline double area(const Corners& v) { return 0.5 * (v[1] - v[0]).cross(v[2] - v[0]).norm(); }

// Nodes and weights on (0, 1), eight points.
inline const std::array<std::array<double, 2>, 8>& gauss8() {
  static const auto rule = [] {
    // Abscissae of the Legendre polynomial of degree 8 and their weights, halved interval.
    constexpr double x[4] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                             0.96028985649753623};
    constexpr double w[4] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                             0.10122853629037626};
    std::array<std::array<double, 2>, 8> points;
    for (int i = 0; i < 4; ++i) {
      points[2 * i] = {0.5 - 0.5 * x[i], 0.5 * w[i]};
      points[2 * i + 1] = {0.5 + 0.5 * x[i], 0.5 * w[i]};
    }
    return points;
  }();
  return rule;
}

// Integral of f(y, phi_0, phi_1, phi_2) over a triangle by 64 points collapsed towards corner 0.
template <class Value, class Function>
Value integrate_collapsed(const Corners& v, const Corners& phi, Function&& f) {
  Value sum = Value::Zero();
  const double twice = 2.0 * area(v);
  for (const auto& [s, ws] : gauss8()) {
    for (const auto& [t, wt] : gauss8()) {
      const double b1 = s * (1.0 - t), b2 = s * t, b0 = 1.0 - s;
      sum += ws * wt * s * twice *
             f(Vec3(b0 * v[0] + b1 * v[1] + b2 * v[2]), Vec3(b0 * phi[0] + b1 * phi[1] + b2 * phi[2]));
    }
  }
  return sum;
}

inline const Corners kUnitShapes = {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2)};

// The same for f that varies steeply near a point x off the triangle: quartered until every piece is small
// against its distance.
template <class Value, class Function>
Value integrate_near(const Corners& v, const Corners& phi, const Vec3& x, Function&& f) {
  const double longest = std::max({(v[1] - v[0]).norm(), (v[2] - v[1]).norm(), (v[0] - v[2]).norm()});
  if (longest <= 0.5 * ((v[0] + v[1] + v[2]) / 3.0 - x).norm()) return integrate_collapsed<Value>(v, phi, f);
  const Corners m = {0.5 * (v[0] + v[1]), 0.5 * (v[1] + v[2]), 0.5 * (v[2] + v[0])};
  const Corners q = {0.5 * (phi[0] + phi[1]), 0.5 * (phi[1] + phi[2]), 0.5 * (phi[2] + phi[0])};
  return integrate_near<Value>({v[0], m[0], m[2]}, {phi[0], q[0], q[2]}, x, f) +
         integrate_near<Value>({v[1], m[1], m[0]}, {phi[1], q[1], q[0]}, x, f) +
         integrate_near<Value>({v[2], m[2], m[1]}, {phi[2], q[2], q[1]}, x, f) +
         integrate_near<Value>({m[0], m[1], m[2]}, {q[0], q[1], q[2]}, x, f);
}

// The same for f of order 1/R, x lying inside the triangle: three pieces with a corner at x (Duffy), their
// opposite edges in parts of equal steps of arsinh(s / distance).
template <class Value, class Function>
Value integrate_around(const Corners& v, const Vec3& x, Function&& f) {
  const Vec3 n = normal(v);
  Vec3 phi_x;
  for (int a = 0; a < 3; ++a) {
    const Vec3 gradient = n.cross(v[(a + 2) % 3] - v[(a + 1) % 3]) / (2.0 * area(v));
    phi_x[a] = 1.0 / 3.0 + gradient.dot(x - (v[0] + v[1] + v[2]) / 3.0);
  }
  constexpr int kParts = 16;
  Value sum = Value::Zero();
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = v[k], b = v[(k + 1) % 3], pa = Vec3::Unit(k), pb = Vec3::Unit((k + 1) % 3);
    const Vec3 along = (b - a).normalized();
    const double length = (b - a).norm(), start = along.dot(a - x);
    const double distance = (a - x - start * along).norm();
    if (distance < 1e-12 * length) continue;  // x on this edge's line
    const double u0 = std::asinh(start / distance), u1 = std::asinh((start + length) / distance);
    const auto fraction = [&](int j) {
      return (distance * std::sinh(u0 + (u1 - u0) * j / kParts) - start) / length;
    };
    for (int i = 0; i < kParts; ++i) {
      const double t0 = fraction(i), t1 = fraction(i + 1);
      sum += integrate_collapsed<Value>({x, a + t0 * (b - a), a + t1 * (b - a)},
                                        {phi_x, pa + t0 * (pb - pa), pa + t1 * (pb - pa)}, f);
    }
  }
  return sum;
}

}  // namespace softpoint::elastic::reference
