// Orientations R_i exp(f(t)) with a cubic turn vector f in each piece. With the right Jacobian J of the
// exponential the angular velocity is J f', in the axes of what turns; its continuity and that of its
// derivative at the knots is a block tridiagonal system for the angular velocities there, nearly linear.
#include <Eigen/Dense>
#include <cmath>

#include "softpoint/core/error.h"
#include "softpoint/figure/spline.h"
#include "spline_pieces.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

using Quaternion = Eigen::Quaterniond;

Quaternion to_quaternion(const std::array<double, 4>& q) { return {q[0], q[1], q[2], q[3]}; }

Quaternion exponential(const Vec3& f) {
  const double angle = f.norm(), half = 0.5 * angle;
  const double s = angle > 1e-4 ? std::sin(half) / angle : 0.5 - angle * angle / 48;
  return {std::cos(half), s * f.x(), s * f.y(), s * f.z()};
}

Vec3 logarithm(Quaternion q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double s = q.vec().norm();
  return q.vec() * (s > 1e-9 ? 2 * std::atan2(s, q.w()) / s : 2.0);
}

// J = 1 - a [f] + b [f]^2 and what multiplies f.f' in the rates of a and b.
struct Coefficients {
  double a, b, a_rate, b_rate;
};

Coefficients coefficients(const Vec3& f) {
  const double x = f.squaredNorm();
  if (x < 0.01) {
    return {0.5 - x * (1.0 / 24 - x * (1.0 / 720 - x / 40320)),
            1.0 / 6 - x * (1.0 / 120 - x * (1.0 / 5040 - x / 362880)),
            -1.0 / 12 + x * (1.0 / 180 - x * (1.0 / 6720 - x / 453600)),
            -1.0 / 60 + x * (1.0 / 1260 - x * (1.0 / 60480 - x / 4989600))};
  }
  const double angle = std::sqrt(x), s = std::sin(angle), half = std::sin(0.5 * angle);
  const double a = 2 * half * half / x, b = (angle - s) / (x * angle);
  return {a, b, (s / angle - 2 * a) / x, (a - 3 * b) / x};
}

Vec3 spin_of(const Vec3& f, const Vec3& rate) {
  const Coefficients c = coefficients(f);
  const Vec3 once = f.cross(rate);
  return rate - c.a * once + c.b * f.cross(once);
}

// The derivative of spin_of() along a curve with this rate and second derivative.
Vec3 spin_change_of(const Vec3& f, const Vec3& rate, const Vec3& second) {
  const Coefficients c = coefficients(f);
  const Vec3 once = f.cross(rate), along = f.cross(second);
  const double stretch = f.dot(rate);
  return second - c.a_rate * stretch * once - c.a * along + c.b_rate * stretch * f.cross(once) +
         c.b * (rate.cross(once) + f.cross(along));
}

Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Mat3 jacobian(const Vec3& f) {
  const Coefficients c = coefficients(f);
  const Mat3 s = skew(f);
  return Mat3::Identity() - c.a * s + c.b * s * s;
}

}  // namespace

TurnSpline::TurnSpline(std::vector<double> times, std::vector<std::array<double, 4>> turns,
                       const TurnSplineEnd& first, const TurnSplineEnd& last)
    : times_(std::move(times)), turns_(std::move(turns)) {
  check_spline_times(times_, turns_.size());
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const double length = to_quaternion(turns_[i]).norm();
    check_range("spline turn " + std::to_string(i) + " length", length, 1e-6, 1e6);
    for (double& x : turns_[i]) x /= length;
  }
  for (const TurnSplineEnd* end : {&first, &last}) {
    if (end->spin) check_range("spline end spin", *end->spin, -1e9, 1e9);
  }
  const std::size_t n = times_.size();
  std::vector<Mat3> forth(n - 1), back(n - 1);  // J at a piece's end, and its inverse
  rises_.resize(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    rises_[i] = logarithm(to_quaternion(turns_[i]).conjugate() * to_quaternion(turns_[i + 1]));
    forth[i] = jacobian(rises_[i]);
    back[i] = forth[i].inverse();
  }
  const auto length = [&](std::size_t i) { return times_[i + 1] - times_[i]; };
  // The rate of the polynomial through up to four turns, as turn vectors from the end: there f = 0 and J = 1.
  const auto estimate = [&](std::size_t at, int step) {
    const std::size_t count = std::min<std::size_t>(n, 4);
    Vec3 spin = Vec3::Zero();
    const auto index = [&](std::size_t k) { return step > 0 ? at + k : at - k; };
    for (std::size_t k = 1; k < count; ++k) {
      const double own = times_[index(k)] - times_[at];
      double weight = 1 / own;
      for (std::size_t j = 1; j < count; ++j) {
        const double other = times_[index(j)] - times_[at];
        if (j != k) weight *= other / (other - own);
      }
      spin += weight * logarithm(to_quaternion(turns_[at]).conjugate() * to_quaternion(turns_[index(k)]));
    }
    return spin;
  };
  std::vector<Vec3> spins(n, Vec3::Zero());
  spins[0] = first.spin ? *first.spin : estimate(0, 1);
  spins[n - 1] = last.spin ? *last.spin : estimate(n - 1, -1);

  // Knot i: (2/h) J w_i-1 + 4 (1/h + 1/k) w_i + (2/k) J^-1 w_i+1 = 6 (f_i-1 / h^2 + f_i / k^2) - bend(w_i)
  std::vector<Mat3> above(n);
  std::vector<Vec3> right(n);
  for (int round = 0; round < 100; ++round) {
    double change = 0, size = 0;
    above[0].setZero();
    right[0] = spins[0];
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const double h = length(i - 1), k = length(i);
      const Vec3 rate = back[i - 1] * spins[i];  // of f at the end of the piece before
      const Vec3 bend = spin_change_of(rises_[i - 1], rate, Vec3::Zero());
      const Mat3 below = 2 / h * forth[i - 1];
      const Mat3 pivot = (4 * (1 / h + 1 / k) * Mat3::Identity() - below * above[i - 1]).inverse();
      above[i] = pivot * (2 / k * back[i]);
      right[i] = pivot * (6 * (rises_[i - 1] / (h * h) + rises_[i] / (k * k)) - bend - below * right[i - 1]);
    }
    for (std::size_t i = n - 1; i-- > 1;) {
      const Vec3 next = right[i] - above[i] * spins[i + 1];
      change = std::max(change, (next - spins[i]).norm());
      size = std::max(size, next.norm());
      spins[i] = next;
    }
    if (change <= 1e-15 * size) break;
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    rates0_.push_back(spins[i]);
    rates1_.push_back(back[i] * spins[i + 1]);
  }
}

TurnSplinePoint TurnSpline::at(double time) const {
  const std::size_t i = spline_piece(times_, time);
  const double h = times_[i + 1] - times_[i], u = (time - times_[i]) / h;
  const Vec3 r0 = h * rates0_[i], r1 = h * rates1_[i];
  const Vec3 c2 = 3 * rises_[i] - 2 * r0 - r1, c3 = r0 + r1 - 2 * rises_[i];
  const Vec3 f = u * (r0 + u * (c2 + u * c3));
  const Vec3 rate = (r0 + u * (2 * c2 + 3 * u * c3)) / h;
  const Vec3 second = (2 * c2 + 6 * u * c3) / (h * h);
  const Quaternion turn = (to_quaternion(turns_[i]) * exponential(f)).normalized();
  return {{turn.w(), turn.x(), turn.y(), turn.z()}, spin_of(f, rate), spin_change_of(f, rate, second)};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
