#include "bone_energy.h"

#include <Eigen/Geometry>

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// A bone as a vector: its length, direction, and how much its direction counts, which falls from 1 to 0 as
// it folds to nothing.
struct Edge {
  Vec3 direction = Vec3::Zero();
  double length = 0;
  double weight = 0, weight_slope = 0;  // 1, 1/m
};

Edge edge_of(const Vec3& from, const Vec3& to, double rest) {
  constexpr double kFolded = 0.1;  // of the rest length: half the weight
  Edge e;
  const Vec3 along = to - from;
  e.length = along.norm();
  e.direction = along / std::max(e.length, 1e-12 * rest);
  const double t = e.length / rest, q = t * t + kFolded * kFolded;
  // Whole at rest, where a bone usually is.
  const double whole = 1.0 + kFolded * kFolded;
  e.weight = whole * t * t / q;
  e.weight_slope = whole * 2.0 * t * kFolded * kFolded / (q * q * rest);
  return e;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

}  // namespace

BoneShape bone_shape(std::span<const Vec3> joints) {
  BoneShape shape;
  for (std::size_t i = 1; i < joints.size(); ++i) {
    shape.lengths.push_back((joints[i] - joints[i - 1]).norm());
    if (i >= 2) {
      shape.angles.push_back(angle_between(joints[i - 1] - joints[i - 2], joints[i] - joints[i - 1]));
    }
  }
  return shape;
}

double bone_energy(const BoneSettings& settings, const BoneShape& shape, std::span<const Vec3> joints,
                   std::span<Vec3> gradient) {
  double energy = 0;
  Edge before;
  for (std::size_t i = 1; i < joints.size(); ++i) {
    const Edge edge = edge_of(joints[i - 1], joints[i], shape.lengths[i - 1]);
    // (5): k (L - l) along the bone.
    const double stretch = edge.length - shape.lengths[i - 1];
    energy += 0.5 * settings.length_stiffness * stretch * stretch;
    const Vec3 pull = settings.length_stiffness * stretch * edge.direction;
    gradient[i] += pull;
    gradient[i - 1] -= pull;
    if (i >= 2 && settings.angle_stiffness > 0.0) {
      // (6): d theta / d X_i = N / L on either side of the joint, N the unit normals in the bones' plane.
      const double cosine = before.direction.dot(edge.direction);
      const double sine = before.direction.cross(edge.direction).norm();
      const double bend = std::atan2(sine, cosine) - shape.angles[i - 2];
      const double c = settings.angle_stiffness, w = before.weight * edge.weight;
      energy += 0.5 * c * w * bend * bend;
      const double over_sine = sine > 1e-12 ? 1.0 / sine : 0.0;
      const Vec3 n_before = -over_sine * (edge.direction - cosine * before.direction);
      const Vec3 n_after = -over_sine * (before.direction - cosine * edge.direction);
      const auto per_length = [](const Edge& e) { return e.length > 0.0 ? 1.0 / e.length : 0.0; };
      const Vec3 at_before = c * bend *
                             (w * per_length(before) * n_before +
                              0.5 * bend * before.weight_slope * edge.weight * before.direction);
      const Vec3 at_after =
          c * bend *
          (w * per_length(edge) * n_after + 0.5 * bend * edge.weight_slope * before.weight * edge.direction);
      gradient[i] += at_after;
      gradient[i - 1] += at_before - at_after;
      gradient[i - 2] -= at_before;
    }
    before = edge;
  }
  return energy;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
