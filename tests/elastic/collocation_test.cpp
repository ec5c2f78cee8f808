// The plain method of the elastic-character paper and of ARTDEFO, H U = G T collocated at the vertices with
// one traction vector each: slow, obvious, and the reason why the library does not use it.
#include <gtest/gtest.h>

#include "elastic_support.h"
#include "reference_kernels.h"

namespace softpoint::elastic {
namespace {

using reference::Corners;

struct Collocation {
  Matrix h, g;  // 3V x 3V
};

// Duffy: collapsed towards the corner where the collocation point lies.
Collocation collocate(const TriangleMesh& mesh, double young, double nu) {
  const double mu = young / (2.0 * (1.0 + nu));
  const int n = 3 * mesh.vertex_count();
  Collocation result = {Matrix::Zero(n, n), Matrix::Zero(n, n)};
  using Both = Eigen::Matrix<double, 3, 18>;  // U phi_a and T phi_a
  for (int i = 0; i < mesh.vertex_count(); ++i) {
    const Vec3 x = mesh.vertices[i];
    for (const Triangle& triangle : mesh.triangles) {
      // Rotated so that a corner at x comes first.
      int first = 0;
      for (int a = 0; a < 3; ++a) first = triangle[a] == i ? a : first;
      const bool touches = triangle[first] == i;
      Corners v;
      for (int a = 0; a < 3; ++a) v[a] = mesh.vertices[triangle[(first + a) % 3]];
      const Vec3 normal = reference::normal(v);
      const auto integrand = [&](const Vec3& y, const Vec3& phi) {
        const Mat3 u = reference::kelvin_displacement(x, y, mu, nu);
        const Mat3 t = reference::kelvin_traction(x, y, normal, nu);
        Both value;
        for (int a = 0; a < 3; ++a) {
          value.block<3, 3>(0, 3 * a) = phi[a] * u;
          value.block<3, 3>(0, 9 + 3 * a) = phi[a] * t;
        }
        return value;
      };
      Both integral = reference::integrate_collapsed<Both>(v, reference::kUnitShapes, integrand);
      // T phi_0 is strongly singular there; it goes into the diagonal, by rigid translation below.
      if (touches) integral.middleCols<3>(9).setZero();
      for (int a = 0; a < 3; ++a) {
        const int column = 3 * triangle[(first + a) % 3];
        result.g.block<3, 3>(3 * i, column) += integral.block<3, 3>(0, 3 * a);
        result.h.block<3, 3>(3 * i, column) += integral.block<3, 3>(0, 9 + 3 * a);
      }
    }
    Mat3 sum = Mat3::Zero();
    for (int j = 0; j < mesh.vertex_count(); ++j) sum += result.h.block<3, 3>(3 * i, 3 * j);
    result.h.block<3, 3>(3 * i, 3 * i) -= sum;
  }
  return result;
}

TEST(VertexCollocation, IsFarOffOnAClampedCylinder) {
  const TriangleMesh mesh = standard_part();
  const Collocation c = collocate(mesh, 1e5, 0.3);
  const int n = 3 * mesh.vertex_count();
  std::vector<char> held(n, 0);
  Matrix u = Matrix::Zero(n, 2);
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 x = mesh.vertices[v];
    if (std::abs(x.z()) < 0.499) continue;
    for (int k = 0; k < 3; ++k) held[3 * v + k] = 1;
    if (x.z() > 0) u.row(3 * v + 2) << 0.1, -0.0872665 * x.x();
  }
  // Unknown: tractions where held, displacements where free.
  Matrix unknown = c.h;
  for (int i = 0; i < n; ++i) {
    if (held[i]) unknown.col(i) = -c.g.col(i);
  }
  const Matrix solution = unknown.partialPivLu().solve(-c.h * u);
  double stretch = 0.0, moment = 0.0;
  for (int f : faces_on(mesh, 2, 0.5)) {
    const double share = triangle_area(mesh, f) / 12.0;
    Vec3 sum = Vec3::Zero();
    for (int v : mesh.triangles[f]) sum += mesh.vertices[v];
    for (int v : mesh.triangles[f]) {
      stretch += 4.0 * share * solution(3 * v + 2, 0);
      // M_y = -int x t_z, both linear over the triangle.
      moment -= share * (mesh.vertices[v].x() + sum.x()) * solution(3 * v + 2, 1);
    }
  }
  const double stretch_error = 100.0 * (stretch / 8280.476 - 1.0),
               moment_error = 100.0 * (moment / 862.669 - 1.0);
  std::printf("vertex collocation, 82 vertices: stretch %+.1f %%, bending %+.1f %%\n", stretch_error,
              moment_error);
  EXPECT_NEAR(stretch_error, -25.8, 3.0);
  EXPECT_NEAR(moment_error, -48.0, 4.0);
}

}  // namespace
}  // namespace softpoint::elastic
