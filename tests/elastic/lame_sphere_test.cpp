// Lame's hollow sphere under inner pressure: order of convergence of the displacement.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "elastic_support.h"
#include "support/tier.h"

namespace softpoint::elastic {
namespace {

// Two concentric shells of a cube grid blown up to spheres, n cells along an edge of the cube; the tangent
// evens out the cells. Of even n only: alternating diagonals make odd grids another family.
TriangleMesh hollow_cubed_sphere(int n, double outer, double inner) {
  const TriangleMesh cube = box_grid(n, n, n, Vec3(2, 2, 2));
  TriangleMesh mesh;
  for (double radius : {outer, inner}) {
    const int base = mesh.vertex_count();
    for (const Vec3& x : cube.vertices) {
      mesh.vertices.push_back(radius * (x * (std::numbers::pi / 4)).array().tan().matrix().normalized());
    }
    for (Triangle t : cube.triangles) {
      for (int& v : t) v += base;
      if (radius == inner) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

// u_r for E = 1e5 Pa, nu = 0.3, radii 0.5 and 1 m, 1000 Pa inside: 0.004 and 0.0015 m at the two radii.
double exact_radial(double r) {
  const double a = 0.5, b = 1.0, p = 1000.0, e = 1e5, nu = 0.3;
  return p * a * a * a / (e * (b * b * b - a * a * a)) *
         ((1 - 2 * nu) * r + (1 + nu) * b * b * b / (2 * r * r));
}

double displacement_error(const TriangleMesh& mesh) {
  StaticProblem problem{mesh, {1e5, 0.3, 1000.0}, {}, {}};
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    if (mesh.vertices[mesh.triangles[f][0]].norm() < 0.75) {
      problem.traction.push_back({{f}, -1000.0 * triangle_normal(mesh, f)});
    }
  }
  const StaticResult result = solve_statics(problem);
  const std::vector<double> weight = vertex_areas(mesh);
  double error = 0.0, norm = 0.0;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 exact = exact_radial(mesh.vertices[v].norm()) * mesh.vertices[v].normalized();
    error += weight[v] * (result.displacement[v] - exact).squaredNorm();
    norm += weight[v] * exact.squaredNorm();
  }
  return std::sqrt(error / norm);
}

struct Member {
  double cells;  // along one edge of the parent shape
  TriangleMesh mesh;
};

// Prints the family's table; every order must reach 1.8. The last error is returned.
double converge(const char* family, const std::vector<Member>& members) {
  std::printf("Lame hollow sphere, %s\n vertices triangles  L2 error of u  order\n", family);
  double before = 0.0, cells = 0.0;
  for (const Member& member : members) {
    const double error = displacement_error(member.mesh);
    std::printf("%9d %9d %14.6f", member.mesh.vertex_count(), member.mesh.triangle_count(), error);
    if (before > 0.0) {
      const double order = std::log(before / error) / std::log(member.cells / cells);
      std::printf(" %6.2f", order);
      EXPECT_GE(order, 1.8);
    }
    std::printf("\n");
    before = error;
    cells = member.cells;
  }
  return before;
}

TEST(LameSphere, FormulaGivesTheKnownDisplacements) {
  EXPECT_NEAR(exact_radial(0.5), 0.004, 1e-12);
  EXPECT_NEAR(exact_radial(1.0), 0.0015, 1e-12);
}

TEST(LameSphere, ConvergesWithSecondOrderOnSplitIcosahedra) {
  std::vector<Member> members = {{2, hollow_sphere(1.0, 0.5, 1)}, {4, hollow_sphere(1.0, 0.5, 2)}};
  if (full_tier()) members.push_back({8, hollow_sphere(1.0, 0.5, 3)});
  EXPECT_LE(converge("split icosahedra", members), 0.006);
}

TEST(LameSphere, ConvergesWithSecondOrderOnCubedSpheres) {
  if (kInstrumented) GTEST_SKIP() << "of accuracy, not of memory";
  std::vector<Member> members;
  for (int n : {4, 6, 8}) members.push_back({static_cast<double>(n), hollow_cubed_sphere(n, 1.0, 0.5)});
  if (full_tier()) members.push_back({10, hollow_cubed_sphere(10, 1.0, 0.5)});
  EXPECT_LE(converge("cubed spheres", members), 0.008);
}

}  // namespace
}  // namespace softpoint::elastic
