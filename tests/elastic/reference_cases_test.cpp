// Clamped cylinders against the answers for the true cylinder and for the exact 16-gon prism (E = 1e5 Pa,
// nu = 0.3, r = 0.5 m, L = 1 m; the axisymmetric and three-dimensional solutions behind the figures have
// converged to the digits shown).
#include <gtest/gtest.h>

#include "elastic_support.h"
#include "support/tier.h"

namespace softpoint::elastic {
namespace {

struct Forces {
  double stretch;        // N, top cap moved up by 0.1
  double moment, shear;  // N m and N, top cap turned by 5 degrees, linearised
  double waist;          // m, radial displacement at mid-height, stretched
};

Forces clamped(const TriangleMesh& mesh) {
  const Material material = {1e5, 0.3, 1000.0};
  const std::vector<int> top = vertices_on(mesh, 2, 0.5), bottom = vertices_on(mesh, 2, -0.5);
  StiffnessSettings settings;
  settings.keep_traction = true;
  const auto model = assemble_stiffness(mesh, material.poisson, settings);
  Forces result = {};
  StaticProblem stretch{mesh, material, {{bottom, {0.0, 0.0, 0.0}}, {top, {0.0, 0.0, 0.1}}}, {}};
  const StaticResult stretched = solve_statics(stretch, model);
  for (int v : top) result.stretch += stretched.nodal_force[v].z();
  StaticProblem bend{mesh, material, {{bottom, {0.0, 0.0, 0.0}}}, {}};
  for (int v : top) bend.displacement.push_back({{v}, {0.0, 0.0, -0.0872665 * mesh.vertices[v].x()}});
  const StaticResult bent = solve_statics(bend, model);
  for (int v : top) {
    result.shear += bent.nodal_force[v].x();
    result.moment += (mesh.vertices[v] - Vec3(0, 0, 0.5)).cross(bent.nodal_force[v]).y();
  }
  const int waist = vertex_at(mesh, Vec3(mesh.vertices[bottom.back()].head<2>().norm(), 0, 0));
  result.waist = waist < 0 ? 0.0 : stretched.displacement[waist].x();
  return result;
}

double percent(double value, double exact) { return 100.0 * (value / exact - 1.0); }

struct Mesh {
  int sides, stacks, rings;
};

Forces against_cylinder(const Mesh& m) {
  const TriangleMesh mesh = prism(m.sides, m.stacks, m.rings, 0.5, 1.0, PrismRadius::kEqualArea);
  const Forces f = clamped(mesh);
  const Forces error = {percent(f.stretch, 8280.476), percent(f.moment, 862.669), percent(f.shear, -832.834),
                        percent(f.waist, -0.0159771)};
  std::printf("true cylinder, %4d vertices: stretch %+.3f %%, bending %+.3f %%, shear %+.3f %%\n",
              mesh.vertex_count(), error.stretch, error.moment, error.shear);
  return error;
}

TEST(ClampedCylinder, Of82VerticesIsWithinOnePercent) {
  const Forces error = against_cylinder({16, 4, 1});
  EXPECT_LE(std::abs(error.stretch), 1.0);
  EXPECT_LE(std::abs(error.moment), 0.3);
  EXPECT_LE(std::abs(error.shear), 0.5);
}

TEST(ClampedCylinder, Of738VerticesIsWithinATenthOfAPercent) {
  if (kInstrumented) GTEST_SKIP() << "of accuracy, not of memory";
  const Forces coarse = against_cylinder({16, 8, 2}), fine = against_cylinder({32, 16, 4});
  EXPECT_LE(std::abs(fine.stretch), 0.1);
  EXPECT_LE(std::abs(fine.moment), 0.1);
  EXPECT_LE(std::abs(fine.shear), 0.1);
  EXPECT_LT(std::abs(fine.stretch), std::abs(coarse.stretch));
  EXPECT_LT(std::abs(fine.moment), std::abs(coarse.moment));
}

// No error of geometry is left here.
TEST(ClampedPrism, ApproachesTheExactPrism) {
  const auto error = [](const Mesh& m) {
    const TriangleMesh mesh = prism(m.sides, m.stacks, m.rings, 0.5, 1.0);
    const Forces f = clamped(mesh);
    const Forces result = {percent(f.stretch, 8063.468), percent(f.moment, 826.018),
                           percent(f.shear, -804.834), 0.0};
    std::printf("16-gon prism,  %4d vertices: stretch %+.3f %%, bending %+.3f %%, shear %+.3f %%\n",
                mesh.vertex_count(), result.stretch, result.moment, result.shear);
    return result;
  };
  const Forces coarse = error({16, 4, 1}), fine = error({16, 8, 2});
  EXPECT_LE(std::abs(coarse.stretch), 1.2);
  EXPECT_LE(std::abs(coarse.moment), 1.0);
  EXPECT_LE(std::abs(fine.stretch), 0.5);
  EXPECT_LE(std::abs(fine.moment), 0.4);
  EXPECT_LE(std::abs(fine.shear), 0.4);
}

TEST(ClampedCylinder, WaistNarrowsAsItShould) {
  const Forces error = against_cylinder({16, 8, 2});
  EXPECT_LE(std::abs(error.waist), 2.5);
}

}  // namespace
}  // namespace softpoint::elastic
