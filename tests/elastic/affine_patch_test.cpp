// Constant strain is reproduced exactly on any closed polyhedron, whatever part of the boundary is held
// and whatever part loaded. 1e-10 is the promise; typical figures are 1e-14.
#include <gtest/gtest.h>

#include "elastic_support.h"

namespace softpoint::elastic {
namespace {

constexpr double kGate = 1e-10;

struct Solid {
  const char* name;
  TriangleMesh mesh;
};

class AffinePatch : public testing::TestWithParam<Solid> {
 protected:
  static constexpr double kYoung = 3.7e6;
  const TriangleMesh& mesh() const { return GetParam().mesh; }
  const Material material_ = {kYoung, 0.31, 900.0};
  const Mat3 gradient_ =
      (Mat3() << 0.02, -0.013, 0.007, 0.004, -0.011, 0.017, -0.003, 0.009, 0.015).finished();
  const Vec3 shift_ = {0.1, -0.2, 0.05};

  Vec3 displacement(int v) const { return gradient_ * mesh().vertices[v] + shift_; }
  Vector exact_displacement() const {
    std::vector<Vec3> u;
    for (int v = 0; v < mesh().vertex_count(); ++v) u.push_back(displacement(v));
    return stacked(u);
  }
  Vector exact_force() const {
    Vector force = Vector::Zero(3 * mesh().vertex_count());
    for (int f = 0; f < mesh().triangle_count(); ++f) {
      const Vec3 share =
          stress_of(gradient_, material_) * triangle_normal(mesh(), f) * triangle_area(mesh(), f) / 3;
      for (int v : mesh().triangles[f]) force.segment<3>(3 * v) += share;
    }
    return force;
  }
  double exact_energy() const {
    const Mat3 strain = 0.5 * (gradient_ + gradient_.transpose());
    return 0.5 * stress_of(gradient_, material_).cwiseProduct(strain).sum() * check_closed(mesh()).volume;
  }
  void load_all_faces(StaticProblem& problem) const {
    for (int f = 0; f < mesh().triangle_count(); ++f) {
      problem.traction.push_back({{f}, stress_of(gradient_, material_) * triangle_normal(mesh(), f)});
    }
  }
  static double error(const Vector& value, const Vector& exact) {
    return (value - exact).norm() / exact.norm();
  }
};

TEST_P(AffinePatch, IsExactWhenHeldEverywhere) {
  StaticProblem problem{mesh(), material_, {}, {}};
  for (int v = 0; v < mesh().vertex_count(); ++v) {
    const Vec3 u = displacement(v);
    problem.displacement.push_back({{v}, {u.x(), u.y(), u.z()}});
  }
  const StaticResult result = solve_statics(problem);
  EXPECT_LE(error(stacked(result.nodal_force), exact_force()), kGate);
  EXPECT_NEAR(result.energy / exact_energy(), 1.0, kGate);
  EXPECT_EQ(result.free_rigid_motions, 0);
}

TEST_P(AffinePatch, IsExactWhenLoadedEverywhere) {
  StaticProblem problem{mesh(), material_, {}, {}};
  load_all_faces(problem);
  const StaticResult result = solve_statics(problem);
  EXPECT_LE(error(without_rigid_motion(mesh(), stacked(result.displacement)),
                  without_rigid_motion(mesh(), exact_displacement())),
            kGate);
  EXPECT_LE(error(stacked(result.nodal_force), exact_force()), kGate);
  EXPECT_NEAR(result.energy / exact_energy(), 1.0, kGate);
  EXPECT_EQ(result.free_rigid_motions, 6);
}

TEST_P(AffinePatch, IsExactWhenHalfIsHeldAndHalfLoaded) {
  StaticProblem problem{mesh(), material_, {}, {}};
  load_all_faces(problem);
  for (int v = 0; v < mesh().vertex_count() / 2; ++v) {
    const Vec3 u = displacement(v);
    problem.displacement.push_back({{v}, {u.x(), u.y(), u.z()}});
  }
  const StaticResult result = solve_statics(problem);
  EXPECT_LE(error(stacked(result.displacement), exact_displacement()), kGate);
  EXPECT_NEAR(result.energy / exact_energy(), 1.0, kGate);
}

TEST_P(AffinePatch, IsExactForAnyMixOfComponents) {
  StaticProblem problem{mesh(), material_, {}, {}};
  load_all_faces(problem);
  Noise noise;
  for (int v = 0; v < mesh().vertex_count(); ++v) {
    HeldVertices entry{{v}, {}};
    for (int k = 0; k < 3; ++k) {
      if (noise() < -0.4) entry.value[k] = displacement(v)[k];
    }
    problem.displacement.push_back(entry);
  }
  const StaticResult result = solve_statics(problem);
  EXPECT_LE(error(stacked(result.displacement), exact_displacement()), kGate);
}

INSTANTIATE_TEST_SUITE_P(Solids, AffinePatch,
                         testing::Values(Solid{"Cube", box_grid(3, 3, 3, Vec3(1, 1, 1))},
                                         Solid{"Prism", standard_part()}, Solid{"Sphere", sphere(0.7, 2)},
                                         Solid{"Irregular", irregular_solid()},
                                         Solid{"HollowSphere", hollow_sphere(1.0, 0.5, 1)}),
                         [](const auto& solid) { return std::string(solid.param.name); });

}  // namespace
}  // namespace softpoint::elastic
