#include "group_motion.h"

#include <Eigen/Geometry>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// exp of a turn vector, and the series where the quotient would lose digits.
Eigen::Quaterniond turn_by(const Vec3& d) {
  const double square = d.squaredNorm();
  if (square < 1e-6) {
    const double s = 0.5 - square / 48 + square * square / 3840;
    return {1 - square / 8 + square * square / 384, s * d.x(), s * d.y(), s * d.z()};
  }
  const double angle = std::sqrt(square), s = std::sin(0.5 * angle) / angle;
  return {std::cos(0.5 * angle), s * d.x(), s * d.y(), s * d.z()};
}

// The inverse of the exponential's derivative, (12): side +1 for velocities in the turned axes (ball), -1 for
// those in the world's (free).
Vec3 inverse_derivative(const Vec3& d, const Vec3& spin, double side) {
  const double square = d.squaredNorm();
  double factor = 1.0 / 12 + square / 720 + square * square / 30240;
  if (square > 1e-2) {
    const double half = 0.5 * std::sqrt(square);
    factor = (1 - half / std::tan(half)) / square;
  }
  const Vec3 once = d.cross(spin);
  return spin + 0.5 * side * once + factor * d.cross(once);
}

Vec3 three(const double* from) { return {from[0], from[1], from[2]}; }
Eigen::Quaterniond quaternion(const double* q) { return {q[0], q[1], q[2], q[3]}; }

void keep(Eigen::Quaterniond turn, double* q) {
  turn.normalize();
  q[0] = turn.w();
  q[1] = turn.x();
  q[2] = turn.y();
  q[3] = turn.z();
}

}  // namespace

void move_by(const FigureModel& model, const double* q0, const double* d, double* q1) {
  for (int i = 0; i < model.link_count(); ++i) {
    const int q = model.position_offset(i), v = model.velocity_offset(i);
    switch (model.links()[static_cast<std::size_t>(i)].joint) {
      case JointKind::kHinge:
      case JointKind::kPrismatic:
        q1[q] = q0[q] + d[v];
        break;
      case JointKind::kBall:
        keep(quaternion(q0 + q) * turn_by(three(d + v)), q1 + q);
        break;
      case JointKind::kFree:
        for (int k = 0; k < 3; ++k) q1[q + k] = q0[q + k] + d[v + 3 + k];
        keep(turn_by(three(d + v)) * quaternion(q0 + q + 3), q1 + q + 3);
        break;
      case JointKind::kFixed:
        break;
    }
  }
}

void increment_rate(const FigureModel& model, const double* d, const double* qd, double* rate) {
  for (int i = 0; i < model.link_count(); ++i) {
    const int v = model.velocity_offset(i);
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    const int count = velocity_count(kind);
    for (int k = 0; k < count; ++k) rate[v + k] = qd[v + k];
    if (kind != JointKind::kBall && kind != JointKind::kFree) continue;
    const Vec3 turn = inverse_derivative(three(d + v), three(qd + v), kind == JointKind::kBall ? 1 : -1);
    for (int k = 0; k < 3; ++k) rate[v + k] = turn[k];
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
