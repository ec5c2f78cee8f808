// Segments condensed to their joining surfaces, against the elimination written out and against statics.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <limits>

#include "elastic_support.h"
#include "softpoint/elastic/segment_model.h"
#include "support/characters.h"
#include "support/refusal.h"

namespace softpoint::elastic {
namespace {

Eigen::Map<const Matrix> view(const std::vector<double>& values, Eigen::Index rows) {
  return {values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows};
}

// Positions in vertex-major numbering, of `vertices` taken axis by axis.
std::vector<int> rows_of(const std::vector<int>& vertices) {
  std::vector<int> rows;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int v : vertices) rows.push_back(3 * v + axis);
  }
  return rows;
}

// A solid without symmetry with two interfaces, by the general entry.
SegmentPointer irregular_segment(double young = 2.5e5) {
  const TriangleMesh box = box_grid(3, 2, 4, Vec3(1.0, 0.6, 1.5)), mesh = irregular_solid();
  const auto cap = [&](double z) {
    return interface_of(box, [=](const Vec3& x) { return std::abs(x.z() - z) < 1e-9; });
  };
  return make_segment_model(mesh, {cap(-0.75), cap(0.75)}, {young, 0.35, 900.0}, with_shared_cache());
}

double relative(const Matrix& a, const Matrix& b) { return (a - b).norm() / b.norm(); }

TEST(SegmentModel, HasThePapersUnknowns) {
  const auto model = cylinder_segment();
  EXPECT_EQ(model->joint_points(), 34);
  EXPECT_EQ(model->free_points(), 48);
  EXPECT_EQ(model->interfaces[0].front(), 0);
  EXPECT_EQ(model->interfaces[1].front(), 81);
  EXPECT_NEAR(model->mass, 1000.0 * model->volume, 1e-9);
  EXPECT_NEAR(model->volume, 0.5 * 16 * 0.25 * std::sin(std::numbers::pi / 8), 1e-12);
}

TEST(SegmentModel, IsTheEliminationOfItsFreeVertices) {
  for (const auto& model : {cylinder_segment(), irregular_segment(), torso_segment()}) {
    const SegmentSettings settings = with_shared_cache();
    const auto whole =
        load_or_assemble_stiffness(model->mesh, model->material.poisson, settings.stiffness, settings.cache);
    const Matrix s = model->material.young * matrix_of(*whole);
    const auto joint = rows_of(model->joint_vertices), free = rows_of(model->free_vertices);
    const Eigen::FullPivLU<Matrix> ff(Matrix(s(free, free)));
    const Matrix response = -ff.solve(Matrix(s(free, joint)));
    const Matrix k = s(joint, joint) + s(joint, free) * response;
    EXPECT_LT(relative(view(model->stiffness, static_cast<Eigen::Index>(joint.size())), k), 1e-11);
    EXPECT_LT(relative(view(model->free_response, static_cast<Eigen::Index>(free.size())), response), 1e-11);
    EXPECT_LT(relative(view(model->free_compliance, static_cast<Eigen::Index>(free.size())),
                       ff.solve(Matrix::Identity(ff.rows(), ff.cols()))),
              1e-10);
  }
}

// Caps displaced at random, with gravity, by the static solver on the whole mesh.
TEST(SegmentModel, AnswersAsStaticsDo) {
  const auto model = irregular_segment();
  StaticProblem problem;
  problem.mesh = model->mesh;
  problem.material = model->material;
  problem.gravity = Vec3(3.0, -7.0, 5.0);
  const int joints = model->joint_points(), free = model->free_points();
  Vector u(3 * joints);
  Noise noise;
  for (int i = 0; i < joints; ++i) {
    HeldVertices held;
    held.vertices = {model->joint_vertices[static_cast<std::size_t>(i)]};
    for (int a = 0; a < 3; ++a) held.value[static_cast<std::size_t>(a)] = u[a * joints + i] = 0.02 * noise();
    problem.displacement.push_back(held);
  }
  const StaticResult result = solve_statics(problem);
  const Vec3 b = model->material.density * problem.gravity;
  const Vector f = view(model->stiffness, 3 * joints) * u - view(model->joint_weight, 3 * joints) * b;
  const Vector free_u = view(model->free_response, 3 * free) * u + view(model->free_sag, 3 * free) * b;
  double largest_force = 0, largest_shift = 0;
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < joints; ++i) {
      const auto v = static_cast<std::size_t>(model->joint_vertices[static_cast<std::size_t>(i)]);
      largest_force = std::max(largest_force, std::abs(f[a * joints + i] - result.nodal_force[v][a]));
    }
    for (int i = 0; i < free; ++i) {
      const auto v = static_cast<std::size_t>(model->free_vertices[static_cast<std::size_t>(i)]);
      largest_shift = std::max(largest_shift, std::abs(free_u[a * free + i] - result.displacement[v][a]));
    }
  }
  EXPECT_LT(largest_force, 1e-9 * f.norm());
  EXPECT_LT(largest_shift, 1e-9 * free_u.norm());
}

TEST(SegmentModel, IsSymmetricAndTakesNoEnergy) {
  for (const auto& model : {cylinder_segment(), irregular_segment(), torso_segment(), limb_segment()}) {
    const int joints = model->joint_points();
    const auto k = view(model->stiffness, 3 * joints);
    EXPECT_EQ((k - k.transpose()).norm(), 0.0);
    const Vector values = Eigen::SelfAdjointEigenSolver<Matrix>(Matrix(k)).eigenvalues();
    EXPECT_GE(values[0], -1e-12 * values[values.size() - 1]);
    EXPECT_GT(values[6], 1e-6 * values[values.size() - 1]);  // six rigid motions and no more
    const auto c = view(model->free_compliance, 3 * model->free_points());
    EXPECT_EQ((c - c.transpose()).norm(), 0.0);
  }
}

TEST(SegmentModel, RigidMotionsCostNothing) {
  for (const auto& model : {cylinder_segment(), irregular_segment(), torso_segment()}) {
    const int joints = model->joint_points(), free = model->free_points();
    const Matrix motions = rigid_motions(model->mesh);
    const Matrix at_joints = motions(rows_of(model->joint_vertices), Eigen::all);
    const Matrix at_free = motions(rows_of(model->free_vertices), Eigen::all);
    const auto k = view(model->stiffness, 3 * joints);
    EXPECT_LT((k * at_joints).norm(), 1e-11 * k.norm() * at_joints.norm());
    EXPECT_LT((view(model->free_response, 3 * free) * at_joints - at_free).norm(), 1e-10 * at_free.norm());
  }
}

// Virtual work of a body force in a rigid motion: volume along translations, its moment along rotations.
TEST(SegmentModel, WeightOfTheJointsIsThatOfTheVolume) {
  for (const auto& model : {cylinder_segment(), irregular_segment()}) {
    const Matrix at_joints = rigid_motions(model->mesh)(rows_of(model->joint_vertices), Eigen::all);
    const Matrix work = at_joints.transpose() * view(model->joint_weight, 3 * model->joint_points());
    EXPECT_LT((work.topRows<3>() - model->volume * Mat3::Identity()).norm(), 1e-10 * model->volume);
    Vec3 moment = Vec3::Zero();  // of the volume about the origin
    for (const Triangle& t : model->mesh.triangles) {
      const auto at = [&](std::size_t k) { return model->mesh.vertices[static_cast<std::size_t>(t[k])]; };
      moment += at(0).dot(at(1).cross(at(2))) / 24.0 * (at(0) + at(1) + at(2));
    }
    for (int a = 0; a < 3; ++a) {
      const Vec3 expected = moment.cross(Vec3::Unit(a));
      EXPECT_LT((work.block<3, 1>(3, a) - expected).norm(), 1e-9 * (moment.norm() + model->volume));
    }
  }
}

TEST(SegmentModel, StiffnessGrowsWithYoungsModulus) {
  const auto soft = irregular_segment(1e5), hard = irregular_segment(1e9);
  const int joints = soft->joint_points();
  EXPECT_LT(relative(view(hard->stiffness, 3 * joints), 1e4 * view(soft->stiffness, 3 * joints)), 1e-13);
  EXPECT_EQ(hard->free_response, soft->free_response);
  EXPECT_LT(relative(1e4 * view(hard->free_sag, 3 * hard->free_points()),
                     view(soft->free_sag, 3 * soft->free_points())),
            1e-13);
}

TEST(SegmentModel, RefusesBadInterfacesByName) {
  const TriangleMesh mesh = prism(16, 4, 1, 0.5, 1.0);
  const auto make = [&](const std::vector<std::vector<int>>& interfaces) {
    return [&mesh, interfaces] { make_segment_model(mesh, interfaces, {}, with_shared_cache()); };
  };
  expect_refusal(make({}), {"interfaces is empty", "permitted"});
  expect_refusal(make({{0, 1, 2}, {3, 4}}), {"interface 1", "2 vertices", "permitted are 3 or more"});
  expect_refusal(make({{0, 1, 2}, {3, 4, 82}}), {"interface 1", "vertex", "82", "permitted"});
  expect_refusal(make({{0, 1, -1}, {3, 4, 5}}), {"interface 0", "vertex", "-1", "permitted"});
  expect_refusal(make({{0, 1, 2}, {3, 2, 5}}), {"interface 1", "vertex 2 is named twice", "permitted"});
  expect_refusal(make({{0, 1, 1}}), {"interface 0", "vertex 1 is named twice", "permitted"});
  // One edge of the prism, from the lower rim to the upper.
  expect_refusal(make({{1, 17, 33, 49}}), {"interface 0", "lie on a line", "permitted"});
}

TEST(SegmentModel, RefusesBadMaterialsAndMeshes) {
  const TriangleMesh mesh = prism(16, 4, 1, 0.5, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Material& material :
       {Material{nan, 0.3, 1000}, Material{1e5, 0.5, 1000}, Material{1e5, 0.3, -1.0}}) {
    expect_refusal([&] { make_segment_model(mesh, {{0, 1, 2}}, material); }, {"permitted"});
  }
  TriangleMesh open = mesh;
  open.triangles.pop_back();
  expect_refusal([&] { make_segment_model(open, {{0, 1, 2}}, {}); }, {"segment"});
  for (const double bad : {nan, 0.0, -1.0}) {
    EXPECT_THROW(make_prism_segment(16, 4, bad, 1.0, {}), Error);
    EXPECT_THROW(make_prism_segment(16, 4, 0.5, bad, {}), Error);
  }
  EXPECT_THROW(make_prism_segment(2, 4, 0.5, 1.0, {}), Error);
  EXPECT_THROW(make_prism_segment(16, 0, 0.5, 1.0, {}), Error);
}

}  // namespace
}  // namespace softpoint::elastic
