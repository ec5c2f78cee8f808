#pragma once

#include <Eigen/Dense>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "softpoint/core/shapes.h"
#include "softpoint/elastic/boundary_stiffness.h"
#include "softpoint/elastic/statics.h"
#include "support/tier.h"

namespace softpoint::elastic {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

inline Eigen::Map<const Matrix> matrix_of(const BoundaryStiffness& model) {
  return {model.unit_stiffness.data(), model.dofs(), model.dofs()};
}

// The same numbers on every machine, in [-1, 1].
class Noise {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
  }

 private:
  std::uint64_t state_ = 20240517;
};

// A box with displaced vertices: no symmetry, no two triangles alike, bent faces.
inline TriangleMesh irregular_solid() {
  TriangleMesh mesh = box_grid(3, 2, 4, Vec3(1.0, 0.6, 1.5));
  Noise noise;
  for (Vec3& x : mesh.vertices) {
    const Vec3 shift = Vec3(noise(), noise(), noise()) * 0.07;
    x += shift + Vec3(0.3 * x.z() * x.z() + 0.2, -0.1, 0.2 * x.x());
  }
  return mesh;
}

inline TriangleMesh standard_part(PrismRadius meaning = PrismRadius::kEqualArea) {
  return prism(16, 4, 1, 0.5, 1.0, meaning);
}

inline Mat3 stress_of(const Mat3& gradient, const Material& material) {
  const double nu = material.poisson, mu = material.young / (2.0 * (1.0 + nu));
  const double lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
  return lambda * gradient.trace() * Mat3::Identity() + mu * (gradient + gradient.transpose());
}

inline Vector stacked(const std::vector<Vec3>& points) {
  Vector result(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    result.segment<3>(3 * static_cast<Eigen::Index>(i)) = points[i];
  }
  return result;
}

// 3V x 6: translations and rotations about the origin.
inline Matrix rigid_motions(const TriangleMesh& mesh) {
  Matrix motions(3 * mesh.vertex_count(), 6);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    for (int k = 0; k < 3; ++k) {
      motions.block<3, 1>(3 * v, k) = Vec3::Unit(k);
      motions.block<3, 1>(3 * v, 3 + k) = Vec3::Unit(k).cross(mesh.vertices[v]);
    }
  }
  return motions;
}

// u without its best-fitting rigid motion.
inline Vector without_rigid_motion(const TriangleMesh& mesh, const Vector& u) {
  const Matrix motions = rigid_motions(mesh);
  return u - motions * motions.colPivHouseholderQr().solve(u);
}

inline int vertex_at(const TriangleMesh& mesh, const Vec3& x) {
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if ((mesh.vertices[v] - x).norm() < 1e-9) return v;
  }
  return -1;
}

// Vertices with coordinate `axis` at `value`.
inline std::vector<int> vertices_on(const TriangleMesh& mesh, int axis, double value) {
  std::vector<int> found;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.vertices[v][axis] - value) < 1e-9) found.push_back(v);
  }
  return found;
}

inline std::vector<int> faces_on(const TriangleMesh& mesh, int axis, double value) {
  std::vector<int> found;
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    bool all = true;
    for (int v : mesh.triangles[f]) all = all && std::abs(mesh.vertices[v][axis] - value) < 1e-9;
    if (all) found.push_back(f);
  }
  return found;
}

}  // namespace softpoint::elastic
