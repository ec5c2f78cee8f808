#include "softpoint/core/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "support/refusal.h"

namespace softpoint {
namespace {

// V - E + F
int euler_characteristic(const TriangleMesh& mesh) {
  return mesh.vertex_count() - static_cast<int>(unique_edges(mesh).size()) + mesh.triangle_count();
}

// The index of the vertex at `x`, or -1.
int vertex_at(const TriangleMesh& mesh, const Vec3& x) {
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if ((mesh.vertices[v] - x).norm() < 1e-12) {
      return v;
    }
  }
  return -1;
}

// Is the mesh, triangles included, its own image under the linear map?
bool maps_onto_itself(const TriangleMesh& mesh, const Mat3& map) {
  std::vector<int> image;
  for (const Vec3& x : mesh.vertices) {
    image.push_back(vertex_at(mesh, map * x));
  }
  if (std::count(image.begin(), image.end(), -1) > 0) {
    return false;
  }
  std::set<std::set<int>> triangles, images;
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.insert({a, b, c});
    images.insert({image[a], image[b], image[c]});
  }
  return triangles == images;
}

Mat3 mirror(int axis) {
  Mat3 result = Mat3::Identity();
  result(axis, axis) = -1.0;
  return result;
}

Mat3 turn_about_z(double angle) {
  Mat3 result;
  result << std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1;
  return result;
}

TEST(Prism, HasThePublishedCounts) {
  struct Case {
    int sides, stacks, rings, vertices;
  };
  for (const Case& c : {Case{16, 4, 1, 82}, {16, 8, 2, 178}, {24, 12, 3, 410}, {32, 16, 4, 738}}) {
    const TriangleMesh mesh = prism(c.sides, c.stacks, c.rings, 0.5, 1.0);
    EXPECT_EQ(mesh.vertex_count(), c.vertices);
    EXPECT_EQ(mesh.triangle_count(), 2 * c.vertices - 4);
  }
  EXPECT_EQ(prism(16, 4, 1, 0.5, 1.0).triangle_count(), 160);
}

TEST(Prism, HasTheVolumeAndAreaOfItsPolyhedron) {
  for (const int sides : {3, 4, 7, 16}) {
    for (const int stacks : {1, 5}) {
      for (const int rings : {1, 3}) {
        const double r = 0.5, length = 1.7;
        const MeshReport report = check_closed(prism(sides, stacks, rings, r, length));
        const double section = 0.5 * sides * r * r * std::sin(2.0 * M_PI / sides);
        const double rim = 2.0 * sides * r * std::sin(M_PI / sides);
        EXPECT_NEAR(report.volume, section * length, 1e-13);
        EXPECT_NEAR(report.area, 2.0 * section + rim * length, 1e-13);
      }
    }
  }
}

TEST(Prism, EqualAreaGivesTheCylindersVolume) {
  for (const int sides : {3, 16, 32}) {
    const TriangleMesh mesh = prism(sides, 4, 2, 0.5, 1.0, PrismRadius::kEqualArea);
    EXPECT_NEAR(signed_volume(mesh), M_PI * 0.25, 1e-13);
  }
  const TriangleMesh mesh = prism(16, 4, 1, 0.5, 1.0, PrismRadius::kEqualArea);
  EXPECT_NEAR(mesh.vertices[1].head<2>().norm() / 0.5, 1.0130, 5e-5);
}

TEST(Prism, IsSymmetric) {
  const TriangleMesh mesh = prism(16, 4, 2, 0.5, 1.0);
  EXPECT_TRUE(maps_onto_itself(mesh, turn_about_z(2.0 * M_PI / 8)));
  EXPECT_TRUE(maps_onto_itself(mesh, turn_about_z(M_PI)));
  // One sector on, the diagonals are the other way.
  EXPECT_FALSE(maps_onto_itself(mesh, turn_about_z(2.0 * M_PI / 16)));
  EXPECT_TRUE(maps_onto_itself(mesh, mirror(0)));
  EXPECT_TRUE(maps_onto_itself(mesh, mirror(1)));
}

TEST(Prism, DiagonalsAlternate) {
  // Round every inner vertex of the side the triangle count is 4 or 8, never 6.
  const TriangleMesh mesh = prism(16, 4, 1, 0.5, 1.0);
  std::vector<int> triangles(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const int v : t) {
      ++triangles[v];
    }
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (std::abs(mesh.vertices[v].z()) < 0.3 && mesh.vertices[v].head<2>().norm() > 0.1) {
      EXPECT_TRUE(triangles[v] == 4 || triangles[v] == 8) << v << ": " << triangles[v];
    }
  }
}

TEST(BoxGrid, HasThePublishedCounts) {
  struct Case {
    int cells, vertices;
  };
  for (const Case& c : {Case{1, 8}, {2, 26}, {3, 56}, {4, 98}, {6, 218}, {8, 386}}) {
    const TriangleMesh mesh = box_grid(c.cells, c.cells, c.cells, Vec3(1.0, 1.0, 1.0));
    EXPECT_EQ(mesh.vertex_count(), c.vertices);
    EXPECT_EQ(mesh.triangle_count(), 12 * c.cells * c.cells);
  }
}

TEST(BoxGrid, HasTheVolumeAndAreaOfTheBox) {
  const MeshReport report = check_closed(box_grid(1, 2, 5, Vec3(0.3, 0.7, 2.0)));
  EXPECT_NEAR(report.volume, 0.42, 1e-14);
  EXPECT_NEAR(report.area, 2.0 * (0.21 + 1.4 + 0.6), 1e-14);
}

TEST(BoxGrid, WithEvenCellsIsMirrorSymmetric) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_TRUE(maps_onto_itself(box_grid(2, 4, 6, Vec3(1.0, 2.0, 3.0)), mirror(axis))) << axis;
  }
}

TEST(SquareGrid, IsAFlatOpenSheetFacingUp) {
  const TriangleMesh sheet = square_grid(4, 6, 2.0, 3.0);
  const MeshReport report = check_surface(sheet);
  EXPECT_EQ(sheet.vertex_count(), 35);
  EXPECT_EQ(report.boundary_edges, 20);
  EXPECT_NEAR(report.area, 6.0, 1e-14);
  EXPECT_EQ(euler_characteristic(sheet), 1);
  for (int t = 0; t < sheet.triangle_count(); ++t) {
    EXPECT_EQ(triangle_normal(sheet, t), Vec3(0.0, 0.0, 1.0));
  }
  EXPECT_TRUE(sheet.vertices[1 * 5 + 2].isApprox(Vec3(0.0, -1.0, 0.0)));
  EXPECT_TRUE(maps_onto_itself(sheet, mirror(0)));
  EXPECT_TRUE(maps_onto_itself(sheet, mirror(1)));
}

TEST(Sphere, HasThePublishedCountsAndLiesOnTheSphere) {
  int vertices[] = {12, 42, 162, 642};
  for (int level = 0; level < 4; ++level) {
    const TriangleMesh mesh = sphere(0.3, level);
    EXPECT_EQ(mesh.vertex_count(), vertices[level]);
    for (const Vec3& x : mesh.vertices) {
      EXPECT_NEAR(x.norm(), 0.3, 1e-15);
    }
  }
}

TEST(Sphere, IcosahedronHasItsVolumeAndArea) {
  const double edge = 4.0 / std::sqrt(10.0 + 2.0 * std::sqrt(5.0));
  const MeshReport report = check_closed(sphere(1.0, 0));
  EXPECT_NEAR(report.volume, 5.0 * (3.0 + std::sqrt(5.0)) / 12.0 * std::pow(edge, 3), 1e-14);
  EXPECT_NEAR(report.area, 5.0 * std::sqrt(3.0) * edge * edge, 1e-13);
}

// Error of the volume falls by four from level to level, for every curved generator.
TEST(CurvedShapes, VolumeConvergesWithSecondOrder) {
  const double r = 0.5, length = 1.2, ball = 4.0 / 3.0 * M_PI * r * r * r;
  struct Case {
    const char* name;
    std::function<TriangleMesh(int)> at_level;
    double volume;
  };
  const std::vector<Case> cases = {
      {"sphere", [&](int k) { return sphere(r, k + 1); }, ball},
      {"uv_sphere", [&](int k) { return uv_sphere(r, 8 << k, (8 << k) / 2 - 1); }, ball},
      {"capsule", [&](int k) { return capsule(r, length, 8 << k, 2, 2 << k); }, ball + M_PI * r * r * length},
      {"prism", [&](int k) { return prism(8 << k, 2, 1, r, length); }, M_PI * r * r * length},
      {"hollow_sphere", [&](int k) { return hollow_sphere(r, 0.6 * r, k + 1); }, ball * (1.0 - 0.216)},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    double previous = 0.0;
    for (int level = 0; level < 4; ++level) {
      const double error = c.volume - check_closed(c.at_level(level)).volume;
      EXPECT_GT(error, 0.0);  // an inscribed polyhedron; the shell's outer loss outweighs the inner one
      if (level > 0) {
        EXPECT_NEAR(std::log2(previous / error), 2.0, 0.15);
      }
      previous = error;
    }
    EXPECT_LT(previous, 0.01 * c.volume);
  }
}

TEST(AllShapes, AreClosedAndOfTheSpheresTopology) {
  for (const TriangleMesh& mesh :
       {prism(3, 1, 1, 1.0, 1.0), prism(16, 4, 1, 0.5, 1.0), prism(5, 3, 4, 0.1, 9.0),
        box_grid(1, 1, 1, {1, 1, 1}), box_grid(5, 3, 2, {1, 2, 3}), sphere(1.0, 0), sphere(2.0, 3),
        uv_sphere(1.0, 3, 1), uv_sphere(1.0, 9, 5), capsule(0.2, 0.5), capsule(0.2, 0.5, 3, 1, 1)}) {
    const MeshReport report = check_closed(mesh);
    EXPECT_EQ(report.shells, 1);
    EXPECT_EQ(euler_characteristic(mesh), 2);
  }
  const TriangleMesh hollow = hollow_sphere(1.0, 0.5, 2);
  EXPECT_EQ(check_closed(hollow).shells, 2);
  EXPECT_EQ(check_closed(hollow).bodies, 1);
  EXPECT_EQ(euler_characteristic(hollow), 4);
}

TEST(AllShapes, RefuseParametersByName) {
  const double nan = std::nan("");
  const std::vector<std::pair<std::function<void()>, std::string>> cases = {
      {[] { prism(2, 4, 1, 0.5, 1.0); }, "prism sides = 2"},
      {[] { prism(16, 0, 1, 0.5, 1.0); }, "prism stacks = 0"},
      {[] { prism(16, 4, 0, 0.5, 1.0); }, "prism cap_rings = 0"},
      {[&] { prism(16, 4, 1, nan, 1.0); }, "prism radius = nan"},
      {[] { prism(16, 4, 1, 0.5, -1.0); }, "prism length = -1"},
      {[] { prism(4096, 4096, 1, 0.5, 1.0); }, "prism: these counts make"},
      {[] {
         box_grid(1, 0, 1, {1, 1, 1});
       },
       "box_grid ny = 0"},
      {[] {
         box_grid(1, 1, 1, {1, 1, 0});
       },
       "box_grid size z = 0"},
      {[] { square_grid(5000, 1, 1.0, 1.0); }, "square_grid nx = 5000"},
      {[] { square_grid(1, 1, 1.0, 0.0); }, "square_grid height = 0"},
      {[] { sphere(-1.0); }, "sphere radius = -1"},
      {[] { sphere(1.0, 9); }, "sphere subdivisions = 9"},
      {[] { uv_sphere(1.0, 2, 3); }, "uv_sphere sectors = 2"},
      {[] { uv_sphere(1.0, 3, 0); }, "uv_sphere rings = 0"},
      {[] { capsule(0.1, 0.0); }, "capsule length = 0"},
      {[] { capsule(0.1, 1.0, 8, 1, 0); }, "capsule rings = 0"},
      {[] { hollow_sphere(1.0, 1.0); }, "hollow_sphere inner_radius = 1"},
  };
  for (const auto& [make, fragment] : cases) {
    expect_refusal(make, {fragment, "permitted"});
  }
}

}  // namespace
}  // namespace softpoint
