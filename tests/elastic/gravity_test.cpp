// Bars under their own weight: r = 0.5 m, L = 1 m, E = 1e5 Pa, nu = 0.3, rho g = 1000 N/m^3.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>

#include "elastic_support.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

const Material kMaterial = {1e5, 0.3, 100.0};
const Vec3 kDown = {0, 0, -10.0};

Mat3 oblique() { return Eigen::AngleAxisd(0.8, Vec3(1.0, -0.4, 0.6).normalized()).toRotationMatrix(); }

TriangleMesh turned(TriangleMesh mesh, const Mat3& turn) {
  for (Vec3& x : mesh.vertices) x = turn * x;
  return mesh;
}

// The bar carried by a traction on its top, its axis turned; displacements turned back and zero at the top's
// centre.
struct Hanging {
  StaticResult result;
  std::vector<Vec3> displacement;
};

Hanging hang(const TriangleMesh& mesh, const Mat3& turn) {
  StaticProblem problem{
      turned(mesh, turn), kMaterial, {}, {{faces_on(mesh, 2, 0.5), turn * Vec3(0, 0, 1000)}}};
  problem.gravity = turn * kDown;
  Hanging bar = {solve_statics(problem), {}};
  // Of the rigid motions only those of the top's centre and the axis matter; the bar is symmetric.
  const Vector u = stacked(bar.result.displacement);
  for (const Vec3& value : bar.result.displacement) bar.displacement.push_back(turn.transpose() * value);
  const Vec3 top = bar.displacement[vertex_at(mesh, Vec3(0, 0, 0.5))];
  for (Vec3& value : bar.displacement) value -= top;
  return bar;
}

TEST(HangingBar, IsExactAlongAnAxis) {
  const TriangleMesh mesh = standard_part(PrismRadius::kCircumscribed);
  const Hanging bar = hang(mesh, Mat3::Identity());
  EXPECT_NEAR(bar.displacement[vertex_at(mesh, Vec3(0, 0, -0.5))].z(), -0.005, 1e-12);
  EXPECT_NEAR(bar.displacement[vertex_at(mesh, Vec3(0.5, 0, -0.5))].z(), -0.004625, 1e-12);
  EXPECT_NEAR(bar.displacement[vertex_at(mesh, Vec3(0.5, 0, 0.5))].z(), 0.000375, 1e-12);
  EXPECT_NEAR(bar.displacement[vertex_at(mesh, Vec3(0.5, 0, 0.5))].x(), -0.3 * 0.01 * 0.5, 1e-12);
  // Stress rho g (z + L/2) along the axis alone.
  const double area = check_closed(mesh).volume;
  EXPECT_NEAR(bar.result.energy / (1e6 * area / (6.0 * 1e5)), 1.0, 1e-10);
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    const Vec3 n = triangle_normal(mesh, f);
    const Vec3 exact = n.z() > 0.5 ? Vec3(0, 0, 1000) : Vec3::Zero();
    EXPECT_LE((bar.result.traction[f] - exact).norm(), 1.0) << "face " << f;
  }
}

// Relative to the whole field, by vertices.
double oblique_error(const TriangleMesh& mesh) {
  const Hanging bar = hang(mesh, oblique());
  std::vector<Vec3> exact;
  for (const Vec3& x : mesh.vertices) {
    const double z = 0.5 - x.z(), across = x.head<2>().squaredNorm();
    exact.emplace_back(0.01 *
                       Vec3(-0.3 * x.x() * (1 - z), -0.3 * x.y() * (1 - z), z * z / 2 - z + 0.15 * across));
  }
  const double displacement = (stacked(bar.displacement) - stacked(exact)).norm() / stacked(exact).norm();
  double worst = 0.0;
  for (std::size_t v = 0; v < exact.size(); ++v) {
    worst = std::max(worst, (bar.displacement[v] - exact[v]).norm() / 0.005);
  }
  const double energy = bar.result.energy / (1e6 * check_closed(mesh).volume / 6e5) - 1;
  std::printf(
      "hanging bar, oblique frame, %3d vertices: field %.2f %%, worst vertex %.2f %%, energy %+.2f %%\n",
      mesh.vertex_count(), 100 * displacement, 100 * worst, 100 * energy);
  EXPECT_LE(std::abs(energy), 0.05);
  return displacement;
}

// Three particular fields superposed are no longer the answer itself, so this one sees all of S.
TEST(HangingBar, IsCloseInAnObliqueFrame) {
  const double coarse = oblique_error(prism(16, 4, 1, 0.5, 1.0)),
               fine = oblique_error(prism(16, 8, 2, 0.5, 1.0));
  EXPECT_LE(coarse, 0.06);
  EXPECT_LE(fine, 0.5 * coarse);
}

// On a clamped base, against the true cylinder.
TEST(StandingBar, MatchesTheCylinderInAnyFrame) {
  for (const Mat3& turn : {Mat3(Mat3::Identity()), oblique()}) {
    const TriangleMesh mesh = prism(16, 8, 2, 0.5, 1.0, PrismRadius::kEqualArea);
    StaticProblem problem{turned(mesh, turn), kMaterial, {{vertices_on(mesh, 2, -0.5), {0.0, 0.0, 0.0}}}, {}};
    problem.gravity = turn * kDown;
    const StaticResult result = solve_statics(problem);
    const int rim =
        vertex_at(mesh, Vec3(mesh.vertices[vertices_on(mesh, 2, 0.5).front()].head<2>().norm(), 0, 0.5));
    const double centre_z = (turn.transpose() * result.displacement[vertex_at(mesh, Vec3(0, 0, 0.5))]).z();
    const double rim_z = (turn.transpose() * result.displacement[rim]).z();
    std::printf("standing bar: top centre %+.2f %%, rim %+.2f %%\n", 100 * (centre_z / -0.00493285 - 1),
                100 * (rim_z / -0.00458306 - 1));
    EXPECT_NEAR(centre_z / -0.00493285, 1.0, 0.02);
    EXPECT_NEAR(rim_z / -0.00458306, 1.0, 0.02);
    // The ground carries the weight.
    Vec3 reaction = Vec3::Zero();
    for (const Vec3& f : result.nodal_force) reaction += f;
    EXPECT_LE((reaction + kMaterial.density * check_closed(mesh).volume * problem.gravity).norm(),
              1e-9 * reaction.norm());
  }
}

// Gravity alone leaves a free body no place to rest.
TEST(FreeBody, FallsUnlessItsWeightIsCarried) {
  StaticProblem problem{standard_part(), kMaterial, {}, {}};
  problem.gravity = kDown;
  expect_refusal([&] { solve_statics(problem); }, {"not balanced", "net force"});
}

}  // namespace
}  // namespace softpoint::elastic
