#include "smooth_mesh.h"

#include "shapes.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

SmoothMesh smooth(const TriangleMesh& mesh, double crease = 40) {
  return {mesh.vertices, mesh.triangles, crease};
}

Vec3 normal(const SmoothMesh& mesh, std::size_t i) {
  const float* n = mesh.vertex_data().data() + 6 * i + 3;
  return {n[0], n[1], n[2]};
}

std::size_t copies(const SmoothMesh& mesh) { return mesh.vertex_data().size() / 6; }

TEST(SmoothMesh, BoxCornersHaveOneCopyAFace) {
  const SmoothMesh box = smooth(unit_box());
  EXPECT_EQ(copies(box), 24U);
  for (std::size_t i = 0; i < copies(box); ++i) {
    EXPECT_NEAR(normal(box, i).cwiseAbs().maxCoeff(), 1, 1e-6) << "along an axis";
  }
  EXPECT_EQ(box.edges().size(), 18U) << "12 edges and 6 diagonals";
}

TEST(SmoothMesh, SphereVerticesStayWholeAndPointOutward) {
  const TriangleMesh sphere = unit_sphere(40, 24);
  const SmoothMesh mesh = smooth(sphere);
  EXPECT_EQ(copies(mesh), sphere.vertices.size());
  for (std::size_t i = 0; i < copies(mesh); ++i) {
    EXPECT_GT(normal(mesh, i).dot(mesh.position(static_cast<std::uint32_t>(i))), 0.995);
  }
  // Euler: V - E + F = 2.
  EXPECT_EQ(static_cast<int>(mesh.edges().size()), sphere.vertex_count() + sphere.triangle_count() - 2);
}

TEST(SmoothMesh, CreaseAngleDecides) {
  const TriangleMesh prism = unit_cylinder(8);  // sides meet at 45 degrees, caps at 90
  EXPECT_EQ(copies(smooth(prism, 40)), 8U * 2 * 2 + 2 * 9U);
  EXPECT_EQ(copies(smooth(prism, 50)), 2 * 8U + 2 * 9U);
  EXPECT_EQ(copies(smooth(prism, 100)), 18U);
}

TEST(SmoothMesh, MovingKeepsTheFacesAndRenewsNormalsAndBounds) {
  const TriangleMesh sphere = unit_sphere(20, 12);
  SmoothMesh mesh = smooth(sphere);
  std::vector<Vec3> moved = sphere.vertices;
  for (Vec3& p : moved) p = Vec3(3 * p.x() + 5, p.y(), p.z());
  mesh.move(moved);
  EXPECT_NEAR(mesh.bounds().center.x(), 5, 1e-9);
  EXPECT_NEAR(mesh.bounds().reach(Vec3::UnitX()), 3, 0.05);
  EXPECT_NEAR(mesh.bounds().reach(Vec3::UnitY()), 1, 1e-9);
  for (std::size_t i = 0; i < copies(mesh); ++i) {
    const Vec3 p = mesh.position(static_cast<std::uint32_t>(i));
    const Vec3 gradient = Vec3((p.x() - 5) / 9, p.y(), p.z()).normalized();
    EXPECT_GT(normal(mesh, i).dot(gradient), 0.97);
  }
}

TEST(SmoothMesh, KnowsWhenAVertexIsNotFinite) {
  const TriangleMesh box = unit_box();
  SmoothMesh mesh = smooth(box);
  std::vector<Vec3> moved = box.vertices;
  moved[5].z() = std::numeric_limits<double>::infinity();
  mesh.move(moved);
  EXPECT_FALSE(mesh.finite());
  mesh.move(box.vertices);
  EXPECT_TRUE(mesh.finite());
}

TEST(SmoothMesh, RefusesBrokenInput) {
  TriangleMesh box = unit_box();
  EXPECT_TRUE(mentions(refusal([&] { SmoothMesh(box.vertices, {}, 40); }), "triangles = 0"));
  EXPECT_TRUE(mentions(refusal([&] { smooth(box, 200); }), "crease_degrees = 200"));
  EXPECT_TRUE(
      mentions(refusal([&] { smooth(box).move(std::vector<Vec3>(3, Vec3::Zero())); }), "vertices = 3"));
  box.triangles[4][1] = 8;
  EXPECT_TRUE(mentions(refusal([&] { smooth(box); }), "triangle 4 vertex = 8"));
  box = unit_box();
  box.vertices[2].x() = std::nan("");
  EXPECT_TRUE(mentions(refusal([&] { smooth(box); }), "mesh vertex 2"));
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
