// Laws of the stiffness matrix itself.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cstdlib>
#include <limits>

#include "elastic_support.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

std::vector<TriangleMesh> solids() {
  return {standard_part(), box_grid(3, 3, 3, Vec3(1, 1, 1)), sphere(0.7, 1), irregular_solid(),
          hollow_sphere(1.0, 0.5, 1)};
}

TEST(Stiffness, IsSymmetricBitForBit) {
  for (const TriangleMesh& mesh : solids()) {
    const auto model = assemble_stiffness(mesh, 0.3);
    EXPECT_EQ(matrix_of(*model), matrix_of(*model).transpose());
  }
}

TEST(Stiffness, IsPositiveSemidefiniteWithSixRigidMotions) {
  for (const TriangleMesh& mesh : solids()) {
    for (double poisson : {-0.5, 0.0, 0.3, 0.49}) {
      const auto model = assemble_stiffness(mesh, poisson);
      const Vector values =
          Eigen::SelfAdjointEigenSolver<Matrix>(matrix_of(*model), Eigen::EigenvaluesOnly).eigenvalues();
      const double largest = values[values.size() - 1];
      EXPECT_GE(values[0], -1e-12 * largest);
      EXPECT_LE(values[5], 1e-12 * largest);
      EXPECT_GE(values[6], 1e-4 * largest);
    }
  }
}

TEST(Stiffness, RigidMotionsNeedNoForce) {
  for (const TriangleMesh& mesh : solids()) {
    const auto model = assemble_stiffness(mesh, 0.3);
    const Matrix s = matrix_of(*model);
    const Matrix force = s * rigid_motions(mesh);
    EXPECT_LE(force.cwiseAbs().maxCoeff(), 1e-12 * s.cwiseAbs().maxCoeff());
  }
}

TEST(Stiffness, ForcesHaveNoResultant) {
  for (const TriangleMesh& mesh : solids()) {
    const auto model = assemble_stiffness(mesh, 0.3);
    Noise noise;
    Vector u(model->dofs());
    for (double& x : u) x = noise();
    const Vector force = matrix_of(*model) * u;
    EXPECT_LE((rigid_motions(mesh).transpose() * force).norm(), 1e-12 * force.lpNorm<1>());
  }
}

TEST(Stiffness, GravityColumnsCarryTheVolume) {
  for (const TriangleMesh& mesh : solids()) {
    const auto model = assemble_stiffness(mesh, 0.3);
    const Eigen::Map<const Matrix> columns(model->gravity_columns.data(), model->dofs(), 3);
    const double volume = check_closed(mesh).volume;
    const Matrix resultant = rigid_motions(mesh).transpose() * columns;
    EXPECT_LE((resultant.topRows(3) - volume * Mat3::Identity()).norm(), 1e-12 * volume);
    // The moment of a uniform force about the origin is that of the centre of mass.
    Vec3 first = Vec3::Zero();
    for (const Triangle& t : mesh.triangles) {
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
      first += a.dot(b.cross(c)) / 24.0 * (a + b + c);
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE((resultant.col(k).tail(3) - first.cross(Vec3::Unit(k))).norm(), 1e-12 * volume);
    }
  }
}

TEST(Stiffness, GrowsWithSizeAndIgnoresPlaceAndDirection) {
  const TriangleMesh mesh = irregular_solid();
  const Matrix turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  TriangleMesh moved = mesh;
  for (Vec3& x : moved.vertices) x = 1e-3 * (turn * x) + Vec3(5, -3, 2);
  const auto a = assemble_stiffness(mesh, 0.3), b = assemble_stiffness(moved, 0.3);
  Matrix turns = Matrix::Zero(a->dofs(), a->dofs());
  for (int v = 0; v < mesh.vertex_count(); ++v) turns.block<3, 3>(3 * v, 3 * v) = turn;
  const Matrix expected = 1e-3 * turns * matrix_of(*a) * turns.transpose();
  // Rounding of the coordinates themselves: 5 m against 1 mm.
  EXPECT_LE((matrix_of(*b) - expected).norm(), 1e-9 * expected.norm());
}

TEST(Stiffness, AgreesBetweenInstructionSetsAndRepeatsWithinOne) {
  for (const TriangleMesh& mesh : {standard_part(), irregular_solid()}) {
    StiffnessSettings settings;
    settings.keep_traction = true;
    settings.max_instruction_set = InstructionSet::kBaseline;
    const auto baseline = assemble_stiffness(mesh, 0.3, settings);
    EXPECT_EQ(baseline->instruction_set, InstructionSet::kBaseline);
    for (InstructionSet set : {InstructionSet::kAvx2, InstructionSet::kAvx512}) {
      settings.max_instruction_set = set;
      const auto fast = assemble_stiffness(mesh, 0.3, settings),
                 again = assemble_stiffness(mesh, 0.3, settings);
      EXPECT_LE((matrix_of(*fast) - matrix_of(*baseline)).norm(), 1e-10 * matrix_of(*baseline).norm());
      const Eigen::Map<const Vector> t(fast->unit_traction.data(), fast->unit_traction.size());
      const Eigen::Map<const Vector> t0(baseline->unit_traction.data(), baseline->unit_traction.size());
      EXPECT_LE((t - t0).norm(), 1e-10 * t0.norm());
      EXPECT_EQ(fast->unit_stiffness, again->unit_stiffness);
      EXPECT_EQ(fast->gravity_columns, again->gravity_columns);
      EXPECT_EQ(fast->unit_traction, again->unit_traction);
    }
  }
}

TEST(Stiffness, EnvironmentLimitsTheInstructionSet) {
  const char* before = std::getenv("SOFTPOINT_MAX_ISA");
  const std::string saved = before == nullptr ? "" : before;
  ::setenv("SOFTPOINT_MAX_ISA", "baseline", 1);
  EXPECT_EQ(best_instruction_set(), InstructionSet::kBaseline);
  ::setenv("SOFTPOINT_MAX_ISA", "avx2", 1);
  EXPECT_LE(best_instruction_set(), InstructionSet::kAvx2);
  if (before == nullptr) {
    ::unsetenv("SOFTPOINT_MAX_ISA");
  } else {
    ::setenv("SOFTPOINT_MAX_ISA", saved.c_str(), 1);
  }
}

TEST(Stiffness, TractionOperatorIsKeptOnlyWhenAsked) {
  const TriangleMesh mesh = standard_part();
  StiffnessSettings settings;
  EXPECT_TRUE(assemble_stiffness(mesh, 0.3)->unit_traction.empty());
  settings.keep_traction = true;
  const auto model = assemble_stiffness(mesh, 0.3, settings);
  // Uniform pressure strain: t = sigma n up to quadrature, which the affine correction does not touch.
  const Mat3 gradient = Vec3(0.01, 0.02, -0.015).asDiagonal();
  std::vector<Vec3> u;
  for (const Vec3& x : mesh.vertices) u.push_back(gradient * x);
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const RowMatrix> operator_t(model->unit_traction.data(), 3 * mesh.triangle_count(),
                                               model->dofs());
  const Vector t = operator_t * stacked(u);
  std::vector<Vec3> exact;
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    exact.push_back(stress_of(gradient, {1.0, 0.3, 1.0}) * triangle_normal(mesh, f));
  }
  const double error = (t - stacked(exact)).norm() / stacked(exact).norm();
  std::printf("uncorrected face tractions of a constant strain: relative error %.1e\n", error);
  EXPECT_LE(error, 2e-3);
}

TEST(Stiffness, FinerQuadratureChangesLittle) {
  const TriangleMesh mesh = standard_part();
  StiffnessSettings fine, coarse;
  fine.quadrature = Quadrature::fine();
  coarse.quadrature = Quadrature::coarse();
  const Matrix exact = matrix_of(*assemble_stiffness(mesh, 0.3, fine));
  const double standard = (matrix_of(*assemble_stiffness(mesh, 0.3)) - exact).norm() / exact.norm();
  const double rough = (matrix_of(*assemble_stiffness(mesh, 0.3, coarse)) - exact).norm() / exact.norm();
  std::printf("against fine quadrature: standard %.1e, coarse %.1e\n", standard, rough);
  EXPECT_LE(standard, 1e-3);
  EXPECT_LE(rough, 2e-2);
  EXPECT_LT(standard, rough);
}

TEST(Stiffness, RefusesWhatItCannotMeet) {
  const TriangleMesh mesh = box_grid(1, 1, 1, Vec3(1, 1, 1));
  for (double poisson : {-1.0, 0.495, 0.5, std::numeric_limits<double>::quiet_NaN()}) {
    expect_refusal([&] { assemble_stiffness(mesh, poisson); }, {"material.poisson", "0.49", "-0.9"});
  }
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  expect_refusal([&] { assemble_stiffness(open, 0.3); }, {"mesh"});
  const auto with = [&](Quadrature quadrature) {
    StiffnessSettings settings;
    settings.quadrature = quadrature;
    return [&mesh, settings] { assemble_stiffness(mesh, 0.3, settings); };
  };
  expect_refusal(with({5, 0, 0, 1.5}), {"quadrature.far_points = 5"});
  expect_refusal(with({0, 7, 0, 1.5}), {"quadrature.near_points = 7"});
  expect_refusal(with({0, 0, 17, 1.5}), {"quadrature.near_graded_order = 17"});
  expect_refusal(with({0, 12, 6, 1.5}), {"quadrature.near_graded_order = 6"});
  expect_refusal(with({0, 0, 0, 0.5}), {"quadrature.near_distance = 0.5"});
}

TEST(Stiffness, RefusesMeshesTooLargeForMemoryBeforehand) {
  StiffnessSettings settings;
  settings.memory_limit = 1e6;
  expect_refusal([&] { assemble_stiffness(standard_part(), 0.3, settings); },
                 {"82 vertices", "160 triangles", "0.0058 GB", "0.0010 GB"});
  // Without a limit of one's own: few machines have 2 TB.
  const TriangleMesh huge = box_grid(100, 100, 100, Vec3(1, 1, 1));
  expect_refusal([&] { assemble_stiffness(huge, 0.3); }, {"60002 vertices", "GB"});
}

}  // namespace
}  // namespace softpoint::elastic
