#include "hanging_field.h"

#include <Eigen/Geometry>

namespace softpoint::inline SOFTPOINT_ABI::elastic {

Vec3 mean_vertex(const TriangleMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : mesh.vertices) sum += x;
  return sum / mesh.vertex_count();
}

Vec3 hanging_displacement(const Vec3& x, const Vec3& force, double poisson) {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const double s = x[k];
    Vec3 across = x;
    across[k] = 0.0;
    sum += force[k] * poisson * s * across;
    sum[k] -= 0.5 * force[k] * (s * s + poisson * across.squaredNorm());
  }
  return sum;
}

Mat3 hanging_stress(const Vec3& x, const Vec3& force) { return Vec3(-force.cwiseProduct(x)).asDiagonal(); }

double hanging_energy(const TriangleMesh& mesh, const Vec3& origin, const Vec3& force, double poisson) {
  // sigma : epsilon = (1 + nu) sigma : sigma - nu (tr sigma)^2 is quadratic in x; its moments over the
  // tetrahedra of the origin and the triangles are exact.
  Mat3 moment = Mat3::Zero();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin, b = mesh.vertices[t[1]] - origin,
               c = mesh.vertices[t[2]] - origin;
    const Vec3 sum = a + b + c;
    const double volume = a.dot(b.cross(c)) / 6.0;
    moment +=
        volume / 20.0 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  const Mat3 weighted = force.asDiagonal() * moment * force.asDiagonal();
  return 0.5 * ((1.0 + poisson) * weighted.trace() - poisson * weighted.sum());
}

std::vector<double> hanging_loads(const TriangleMesh& mesh, const Vec3& origin, double poisson,
                                  const std::vector<double>& stiffness) {
  const Eigen::Index n = 3 * static_cast<Eigen::Index>(mesh.vertex_count());
  const Eigen::Map<const Eigen::MatrixXd> s(stiffness.data(), n, n);
  Eigen::MatrixXd field(n, 3);
  for (int k = 0; k < 3; ++k) {
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      field.block<3, 1>(3 * v, k) = hanging_displacement(mesh.vertices[v] - origin, Vec3::Unit(k), poisson);
    }
  }
  std::vector<double> result(3 * static_cast<std::size_t>(n));
  Eigen::Map<Eigen::MatrixXd> load(result.data(), n, 3);
  load.noalias() = s * field;
  // - int phi_a sigma_p n: sigma_p is linear, so int phi_a s = A (s_a + s_0 + s_1 + s_2) / 12.
  for (const Triangle& t : mesh.triangles) {
    Vec3 x[3];
    for (int a = 0; a < 3; ++a) x[a] = mesh.vertices[t[a]] - origin;
    const Vec3 area_normal = 0.5 * (x[1] - x[0]).cross(x[2] - x[0]);
    for (int a = 0; a < 3; ++a) {
      const Vec3 mean = (x[a] + x[0] + x[1] + x[2]) / 12.0;
      for (int k = 0; k < 3; ++k) load(3 * t[a] + k, k) += area_normal[k] * mean[k];
    }
  }
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
