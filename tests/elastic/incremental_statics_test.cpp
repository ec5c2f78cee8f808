// The paper's equation (3): unknowns fixed, only changed known values multiplied.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/incremental_statics.h"
#include "softpoint/elastic/statics.h"

namespace softpoint {
namespace {

using elastic::IncrementalStatics;

constexpr double kYoung = 1e5;

elastic::StiffnessSettings with_traction() {
  elastic::StiffnessSettings settings;
  settings.keep_traction = true;
  return settings;
}

// A bar standing on its clamped lower end.
struct ClampedBar {
  TriangleMesh mesh = prism(8, 3, 1, 0.3, 1.0);
  std::shared_ptr<const elastic::BoundaryStiffness> stiffness =
      elastic::assemble_stiffness(mesh, 0.3, with_traction());
  std::vector<char> held = std::vector<char>(3 * mesh.vertices.size(), 0);
  std::vector<int> clamped, top;

  ClampedBar() {
    for (int v = 0; v < mesh.vertex_count(); ++v) {
      const double z = mesh.vertices[static_cast<std::size_t>(v)].z();
      if (z < -0.499) clamped.push_back(v);
      if (z > 0.499) top.push_back(v);
    }
    for (const int v : clamped) {
      for (int a = 0; a < 3; ++a) held[static_cast<std::size_t>(3 * v + a)] = 1;
    }
  }
};

TEST(IncrementalStatics, AgreesWithTheWholeSolution) {
  const ClampedBar bar;
  IncrementalStatics incremental(bar.stiffness, kYoung, bar.held);
  // The clamped end is moved, and every vertex of the top pushed.
  elastic::StaticProblem problem;
  problem.mesh = bar.mesh;
  problem.material.young = kYoung;
  problem.displacement.push_back({bar.clamped, {0.01, -0.02, 0.03}});
  for (const int v : bar.clamped) {
    incremental.set(3 * v, 0.01);
    incremental.set(3 * v + 1, -0.02);
    incremental.set(3 * v + 2, 0.03);
  }
  std::vector<int> faces;
  std::vector<Vec3> load(bar.mesh.vertices.size(), Vec3::Zero());
  for (int f = 0; f < bar.mesh.triangle_count(); ++f) {
    if (triangle_normal(bar.mesh, f).z() < 0.99) continue;
    faces.push_back(f);
    for (const int v : bar.mesh.triangles[static_cast<std::size_t>(f)]) {
      load[static_cast<std::size_t>(v)] += triangle_area(bar.mesh, f) / 3.0 * Vec3(50, 20, -100);
    }
  }
  problem.traction.push_back({faces, Vec3(50, 20, -100)});
  for (const int v : bar.top) {
    for (int a = 0; a < 3; ++a) incremental.set(3 * v + a, load[static_cast<std::size_t>(v)][a]);
  }
  incremental.update();
  const elastic::StaticResult whole = elastic::solve_statics(problem, bar.stiffness);
  double size = 0, off = 0;
  for (std::size_t v = 0; v < whole.displacement.size(); ++v) {
    const Vec3 u(incremental.displacement().data() + 3 * v);
    size = std::max(size, whole.displacement[v].norm());
    off = std::max(off, (u - whole.displacement[v]).norm());
  }
  EXPECT_LE(off, 1e-10 * size);
  for (const int v : bar.clamped) {
    const Vec3 f(incremental.force().data() + 3 * v);
    EXPECT_LE((f - whole.nodal_force[static_cast<std::size_t>(v)]).norm(), 1e-8);
  }
}

TEST(IncrementalStatics, MultipliesOnlyWhatChanged) {
  const ClampedBar bar;
  IncrementalStatics statics(bar.stiffness, kYoung, bar.held);
  EXPECT_EQ(statics.update(), 0);
  for (const int v : bar.top) statics.set(3 * v, 1.0);
  EXPECT_EQ(statics.update(), static_cast<int>(bar.top.size()));
  EXPECT_EQ(statics.update(), 0);
  statics.set(3 * bar.top[0], 2.0);
  EXPECT_EQ(statics.update(), 1);
  statics.set(3 * bar.top[1], 7.0);
  statics.set(3 * bar.top[1], 1.0);  // as it was
  EXPECT_EQ(statics.update(), 0);
  // Back to rest: nothing is left to multiply.
  for (const int v : bar.top) statics.set(3 * v, 0.0);
  EXPECT_EQ(statics.update(), 0);
  for (const double u : statics.displacement()) EXPECT_EQ(u, 0.0);
}

TEST(IncrementalStatics, ManySmallChangesDoNotDrift) {
  const ClampedBar bar;
  IncrementalStatics steps(bar.stiffness, kYoung, bar.held), once(bar.stiffness, kYoung, bar.held);
  for (const int v : bar.top) steps.set(3 * v + 1, 1.0);
  for (int i = 1; i <= 2500; ++i) {
    steps.set(3 * bar.top[0], std::sin(0.1 * i));
    steps.update();
  }
  for (const int v : bar.top) once.set(3 * v + 1, 1.0);
  once.set(3 * bar.top[0], std::sin(250.0));
  once.update();
  double size = 0, off = 0;
  for (std::size_t i = 0; i < steps.displacement().size(); ++i) {
    size = std::max(size, std::abs(once.displacement()[i]));
    off = std::max(off, std::abs(steps.displacement()[i] - once.displacement()[i]));
  }
  EXPECT_LE(off, 1e-13 * size);
}

TEST(IncrementalStatics, RefusesWhatCannotBe) {
  const ClampedBar bar;
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message([&] { IncrementalStatics(nullptr, kYoung, bar.held); }).find("stiffness"),
            std::string::npos);
  EXPECT_NE(message([&] { IncrementalStatics(bar.stiffness, -1.0, bar.held); }).find("young"),
            std::string::npos);
  const std::vector<char> few(5, 1), none(bar.held.size(), 0);
  EXPECT_NE(message([&] { IncrementalStatics(bar.stiffness, kYoung, few); }).find("held"), std::string::npos);
  EXPECT_NE(message([&] { IncrementalStatics(bar.stiffness, kYoung, none); }).find("loose"),
            std::string::npos);
  IncrementalStatics statics(bar.stiffness, kYoung, bar.held);
  EXPECT_NE(message([&] { statics.set(-1, 0.0); }).find("dof"), std::string::npos);
  EXPECT_NE(message([&] { statics.set(0, std::numeric_limits<double>::quiet_NaN()); }).find("value"),
            std::string::npos);
}

}  // namespace
}  // namespace softpoint
