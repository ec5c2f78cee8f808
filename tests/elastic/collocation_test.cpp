#include "support/vertex_collocation.h"

#include <gtest/gtest.h>

#include "elastic_support.h"

namespace softpoint::elastic {
namespace {

TEST(VertexCollocation, IsFarOffOnAClampedCylinder) {
  const TriangleMesh mesh = standard_part();
  std::vector<int> held;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.vertices[v].z()) > 0.499) held.push_back(v);
  }
  Matrix u = Matrix::Zero(3 * static_cast<int>(held.size()), 2);
  for (std::size_t i = 0; i < held.size(); ++i) {
    const Vec3 x = mesh.vertices[held[i]];
    if (x.z() > 0) u.row(3 * static_cast<Eigen::Index>(i) + 2) << 0.1, -0.0872665 * x.x();
  }
  const Matrix solution = reference::collocation_response(reference::collocate(mesh, Material{}), held) * u;
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
