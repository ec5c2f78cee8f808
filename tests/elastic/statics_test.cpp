// What the solver answers, and what it refuses.
#include "softpoint/elastic/statics.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "elastic_support.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

constexpr std::nullopt_t kFree = std::nullopt;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A 1 m cube, three cells an edge.
TriangleMesh cube() { return box_grid(3, 3, 3, Vec3(1, 1, 1)); }

StaticProblem loaded_cube() { return {cube(), {1e5, 0.3, 1000.0}, {}, {}}; }

TEST(Statics, UniaxialBarStretchesByHooke) {
  StaticProblem problem = loaded_cube();
  problem.displacement = {{vertices_on(problem.mesh, 2, -0.5), {kFree, kFree, 0.0}}};
  problem.traction = {{faces_on(problem.mesh, 2, 0.5), Vec3(0, 0, 500)}};
  const StaticResult result = solve_statics(problem);
  EXPECT_EQ(result.free_rigid_motions, 3);
  for (int v = 0; v < problem.mesh.vertex_count(); ++v) {
    const Vec3 x = problem.mesh.vertices[v];
    const Vec3 exact(-0.0015 * x.x(), -0.0015 * x.y(), 0.005 * (x.z() + 0.5));
    EXPECT_LE((result.displacement[v] - exact).norm(), 1e-12);
  }
  EXPECT_NEAR(result.energy, 0.5 * 500 * 0.005, 1e-10);
  double reaction = 0.0;
  for (int v : vertices_on(problem.mesh, 2, -0.5)) reaction += result.nodal_force[v].z();
  EXPECT_NEAR(reaction, -500.0, 1e-8);
  for (int f = 0; f < problem.mesh.triangle_count(); ++f) {
    EXPECT_LE((result.traction[f] - Vec3(0, 0, 500 * triangle_normal(problem.mesh, f).z())).norm(), 1.0);
  }
}

TEST(Statics, HolderReactionLeavesOutTractionsOnHeldVertices) {
  StaticProblem problem = loaded_cube();
  for (int v = 0; v < problem.mesh.vertex_count(); ++v)
    problem.displacement.push_back({{v}, {0.0, 0.0, 0.0}});
  problem.traction = {
      {faces_on(problem.mesh, 2, 0.5), Vec3(0, 0, 500)}, {{0}, Vec3(3, 0, 0)}, {{0}, Vec3(4, 0, 0)}};
  const StaticResult result = solve_statics(problem);
  Vec3 reaction = Vec3::Zero();
  for (const Vec3& f : result.nodal_force) reaction += f;
  const Vec3 applied(7.0 * triangle_area(problem.mesh, 0), 0, 500);
  EXPECT_LE((reaction + applied).norm(), 1e-10);
  EXPECT_EQ(result.energy, 0.0);
}

// Power: work of the loads is twice the strain energy (Clapeyron).
TEST(Statics, LoadsDoTwiceTheStrainEnergy) {
  StaticProblem problem = loaded_cube();
  problem.mesh = irregular_solid();
  problem.displacement = {{{0, 1, 2, 5}, {0.0, 0.0, 0.0}}};
  problem.traction = {{{10, 11, 30}, Vec3(20, -50, 35)}};
  const StaticResult result = solve_statics(problem);
  double work = 0.0;
  for (std::size_t v = 0; v < result.displacement.size(); ++v)
    work += result.displacement[v].dot(result.nodal_force[v]);
  EXPECT_NEAR(result.energy / (0.5 * work), 1.0, 1e-10);
  EXPECT_GT(result.energy, 0.0);
}

TEST(Statics, CountsTheRigidMotionsThatNothingHolds) {
  const TriangleMesh mesh = cube();
  const auto count = [&](std::vector<HeldVertices> held) {
    StaticProblem problem = loaded_cube();
    problem.displacement = std::move(held);
    return solve_statics(problem).free_rigid_motions;
  };
  const int a = vertex_at(mesh, Vec3(-0.5, -0.5, -0.5)), b = vertex_at(mesh, Vec3(0.5, -0.5, -0.5)),
            c = vertex_at(mesh, Vec3(-0.5, 0.5, -0.5));
  EXPECT_EQ(count({}), 6);
  EXPECT_EQ(count({{{a}, {0.0, 0.0, 0.0}}}), 3);
  EXPECT_EQ(count({{{a, b}, {0.0, 0.0, 0.0}}}), 1);  // the hinge
  EXPECT_EQ(count({{{a, b, c}, {0.0, 0.0, 0.0}}}), 0);
  EXPECT_EQ(count({{{a, b, c}, {kFree, kFree, 0.0}}}), 3);
  EXPECT_EQ(count({{{a}, {0.0, 0.0, 0.0}}, {{b}, {kFree, 0.0, 0.0}}, {{c}, {kFree, kFree, 0.0}}}),
            0);  // 3-2-1
}

TEST(Statics, FreeMotionIsLeftOutInTheMean) {
  StaticProblem problem = loaded_cube();
  problem.traction = {{faces_on(problem.mesh, 0, 0.5), Vec3(100, 0, 0)},
                      {faces_on(problem.mesh, 0, -0.5), Vec3(-100, 0, 0)}};
  const StaticResult result = solve_statics(problem);
  const std::vector<double> area = vertex_areas(problem.mesh);
  Vec3 shift = Vec3::Zero(), turn = Vec3::Zero();
  for (int v = 0; v < problem.mesh.vertex_count(); ++v) {
    shift += area[v] * result.displacement[v];
    turn += area[v] * problem.mesh.vertices[v].cross(result.displacement[v]);
  }
  EXPECT_LE(shift.norm() + turn.norm(), 1e-14);
}

TEST(Statics, HingedBodyBalancesAboutTheHinge) {
  StaticProblem problem = loaded_cube();
  std::vector<int> hinge;
  for (int v : vertices_on(problem.mesh, 0, -0.5)) {
    if (std::abs(problem.mesh.vertices[v].z() + 0.5) < 1e-9) hinge.push_back(v);
  }
  problem.displacement = {{hinge, {0.0, 0.0, 0.0}}};
  problem.gravity = Vec3(0, 0, -10);
  expect_refusal([&] { solve_statics(problem); }, {"not balanced", "moment"});
  // 10 kN at 0.5 m; on the far face 5000 N at 1 m.
  problem.traction = {{faces_on(problem.mesh, 0, 0.5), Vec3(0, 0, 5000)}};
  EXPECT_EQ(solve_statics(problem).free_rigid_motions, 1);
}

TEST(Statics, UnbalancedLoadsAreRefusedWithTheirResultant) {
  StaticProblem problem = loaded_cube();
  problem.traction = {{faces_on(problem.mesh, 0, 0.5), Vec3(0, 200, 0)}};
  const std::string message = refusal([&] { solve_statics(problem); });
  EXPECT_NE(message.find("net force ["), std::string::npos) << message;
  EXPECT_NE(message.find("200"), std::string::npos) << message;
  EXPECT_NE(message.find("moment ["), std::string::npos) << message;
  // Held against y and against turning about z: balanced again.
  problem.displacement = {{vertices_on(problem.mesh, 0, -0.5), {0.0, 0.0, kFree}}};
  EXPECT_EQ(solve_statics(problem).free_rigid_motions, 1);
}

TEST(Statics, BalanceIsJudgedAgainstTheLoads) {
  const auto off_by = [](double fraction) {
    StaticProblem problem = loaded_cube();
    problem.traction = {{faces_on(problem.mesh, 0, 0.5), Vec3(1e-3, 0, 0)},
                        {faces_on(problem.mesh, 0, -0.5), Vec3(-1e-3 * (1 + fraction), 0, 0)}};
    return problem;
  };
  EXPECT_NO_THROW(solve_statics(off_by(1e-7)));
  EXPECT_THROW(solve_statics(off_by(1e-5)), softpoint::Error);
}

TEST(Statics, RefusalsNameTheEntry) {
  const auto with = [](auto change) {
    StaticProblem problem = loaded_cube();
    change(problem);
    return [problem] { solve_statics(problem); };
  };
  using P = StaticProblem;
  expect_refusal(with([](P& p) { p.material.young = -1; }), {"material.young = -1"});
  expect_refusal(with([](P& p) { p.material.poisson = 0.4999; }), {"material.poisson = 0.4999", "0.49"});
  expect_refusal(with([](P& p) { p.material.density = kNan; }), {"material.density = nan"});
  expect_refusal(with([](P& p) { p.gravity.y() = kNan; }), {"gravity", "nan"});
  expect_refusal(with([](P& p) {
                   p.displacement = {{{0}, {kFree, kFree, kFree}}, {{0, 56}, {0.0, kFree, kFree}}};
                 }),
                 {"displacement[1].vertices[1] = 56", "0 to 55"});
  expect_refusal(with([](P& p) {
                   p.displacement = {{{-1}, {0.0, kFree, kFree}}};
                 }),
                 {"displacement[0].vertices[0] = -1"});
  expect_refusal(with([](P& p) {
                   p.displacement = {{{0}, {kFree, kNan, kFree}}};
                 }),
                 {"displacement[0].value[1] = nan"});
  expect_refusal(with([](P& p) {
                   p.displacement = {{{0, 1}, {0.5, kFree, kFree}}, {{1}, {0.25, kFree, kFree}}};
                 }),
                 {"displacement[1].value[0] = 0.25", "0.5", "vertex 1"});
  expect_refusal(with([](P& p) {
                   p.traction = {{{0, 108}, Vec3(1, 0, 0)}};
                 }),
                 {"traction[0].faces[1] = 108", "0 to 107"});
  expect_refusal(with([](P& p) { p.traction = {{{0}, Vec3(1, kNan, 0)}}; }), {"traction[0].value", "nan"});
  expect_refusal(with([](P& p) { p.mesh.triangles.pop_back(); }), {"mesh"});
  expect_refusal(with([](P& p) { p.mesh.triangles[3][0] = 99; }), {"mesh", "99"});
}

TEST(Statics, SameComponentMayBeHeldTwiceAtTheSameValue) {
  StaticProblem problem = loaded_cube();
  problem.displacement = {{vertices_on(problem.mesh, 2, -0.5), {0.0, 0.0, 0.0}}, {{0}, {0.0, kFree, kFree}}};
  problem.gravity = Vec3(0, 0, -9.81);
  EXPECT_NO_THROW(solve_statics(problem));
}

TEST(Statics, GivenStiffnessMustBelongToTheProblem) {
  StaticProblem problem = loaded_cube();
  StiffnessSettings settings;
  settings.keep_traction = true;
  const auto model = assemble_stiffness(problem.mesh, 0.3, settings);
  problem.displacement = {{vertices_on(problem.mesh, 2, -0.5), {0.0, 0.0, 0.0}}};
  problem.gravity = Vec3(0, 0, -9.81);
  EXPECT_EQ(stacked(solve_statics(problem, model).displacement),
            stacked(solve_statics(problem).displacement));
  expect_refusal([&] { solve_statics(problem, assemble_stiffness(problem.mesh, 0.3)); },
                 {"stiffness", "keep_traction"});
  problem.material.poisson = 0.31;
  expect_refusal([&] { solve_statics(problem, model); }, {"stiffness"});
}

TEST(Statics, RefusesMeshesTooLargeForMemory) {
  StiffnessSettings settings;
  settings.memory_limit = 1e5;
  expect_refusal([&] { solve_statics(loaded_cube(), nullptr, settings); }, {"56 vertices", "needs", "GB"});
}

TEST(Statics, MoreStiffnessMeansLessDisplacement) {
  StaticProblem problem = loaded_cube();
  problem.displacement = {{vertices_on(problem.mesh, 2, -0.5), {0.0, 0.0, 0.0}}};
  problem.gravity = Vec3(3, 0, -9.81);
  const Vector soft = stacked(solve_statics(problem).displacement);
  problem.material.young *= 1000.0;
  const Vector hard = stacked(solve_statics(problem).displacement);
  EXPECT_LE((soft - 1000.0 * hard).norm(), 1e-10 * soft.norm());
}

}  // namespace
}  // namespace softpoint::elastic
