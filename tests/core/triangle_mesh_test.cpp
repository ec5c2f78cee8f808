#include "softpoint/core/triangle_mesh.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "softpoint/core/shapes.h"
#include "support/refusal.h"

namespace softpoint {
namespace {

const Vec3 kUnit(1.0, 1.0, 1.0);

TriangleMesh cube(int cells = 2) { return box_grid(cells, cells, cells, kUnit); }

TriangleMesh moved(const TriangleMesh& mesh, const Vec3& offset, double scale = 1.0) {
  return transformed(mesh, scale * Mat3::Identity(), offset);
}

TEST(ClosedMesh, ReportsVolumeAreaAndShells) {
  const MeshReport report = check_closed(cube(3));
  EXPECT_EQ(report.shells, 1);
  EXPECT_EQ(report.bodies, 1);
  EXPECT_EQ(report.boundary_edges, 0);
  EXPECT_NEAR(report.volume, 1.0, 1e-14);
  EXPECT_NEAR(report.area, 6.0, 1e-13);
}

TEST(ClosedMesh, CriteriaDoNotDependOnScaleOrPlace) {
  for (const double scale : {1e-9, 1e-3, 1.0, 1e6}) {
    const MeshReport report = check_closed(moved(cube(3), Vec3(3.0, -2.0, 7.0) * scale, scale));
    EXPECT_NEAR(report.volume / std::pow(scale, 3), 1.0, 1e-12);
  }
}

TEST(ClosedMesh, SubtractsCavitiesAndCountsBodies) {
  const TriangleMesh block = cube(2);
  const TriangleMesh hole = flipped(moved(block, Vec3::Zero(), 0.5));
  const TriangleMesh island = moved(block, Vec3::Zero(), 0.25);
  const TriangleMesh neighbour = moved(block, Vec3(5.0, 0.0, 0.0));
  const MeshReport report = check_closed(merged(merged(block, hole), merged(island, neighbour)));
  EXPECT_EQ(report.shells, 4);
  EXPECT_EQ(report.bodies, 3);
  EXPECT_NEAR(report.volume, 1.0 - 0.125 + 0.015625 + 1.0, 1e-13);
}

TEST(ClosedMesh, RefusesShellsTheWrongWayRound) {
  const TriangleMesh block = cube(2);
  const TriangleMesh small = moved(block, Vec3::Zero(), 0.5);
  expect_refusal([&] { check_closed(flipped(block), "part.obj"); },
                 {"part.obj: shell 0", "inside out", "flip its 48 triangles"});
  expect_refusal([&] { check_closed(merged(block, small)); },
                 {"shell 1 (48 triangles, the first is 48)", "inside shell 0", "cavity", "flip"});
  // The order of the shells in the file plays no part.
  expect_refusal([&] { check_closed(merged(small, block)); }, {"shell 0", "inside shell 1", "cavity"});
  EXPECT_NO_THROW(check_closed(merged(flipped(small), block)));
  // Two bodies side by side whose bounding boxes nest are no cavity.
  const TriangleMesh ring = merged(moved(block, Vec3(2.0, 0.0, 0.0)), moved(block, Vec3(-2.0, 0.0, 0.0)));
  EXPECT_EQ(check_closed(merged(ring, small)).bodies, 3);
}

TEST(ClosedMesh, NestingIsJudgedByTheSurfaceNotByItsBox) {
  // An L-shaped solid; the box sits in its notch, inside its bounding box.
  TriangleMesh bar = box_grid(2, 2, 1, Vec3(2.0, 2.0, 1.0));
  for (Vec3& x : bar.vertices) {
    if (x.x() > 0.5 && x.y() > 0.5) {
      x.head<2>() *= 0.05;
    }
  }
  ASSERT_EQ(check_closed(bar).bodies, 1);
  EXPECT_EQ(check_closed(merged(bar, moved(cube(1), Vec3(0.7, 0.7, 0.0), 0.3))).bodies, 2);
}

TEST(ClosedMesh, RefusesEachDefectNamingTheElement) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TriangleMesh good = cube(2);
  struct Case {
    const char* defect;
    void (*spoil)(TriangleMesh&);
    std::vector<std::string> fragments;
  };
  const std::vector<Case> cases = {
      {"no triangles", [](TriangleMesh& m) { m.triangles.clear(); }, {"0 triangles"}},
      {"index too large",
       [](TriangleMesh& m) { m.triangles[12][1] = 26; },
       {"triangle 12", "vertex 26", "0 to 25"}},
      {"index negative", [](TriangleMesh& m) { m.triangles[12][1] = -1; }, {"triangle 12", "vertex -1"}},
      {"corner twice",
       [](TriangleMesh& m) { m.triangles[7][1] = m.triangles[7][0]; },
       {"triangle 7", "corner twice"}},
      {"unused vertex",
       [](TriangleMesh& m) { m.vertices.emplace_back(0.0, 0.0, 9.0); },
       {"vertex 26 belongs to no triangle", "remove"}},
      {"hole", [](TriangleMesh& m) { m.triangles.erase(m.triangles.begin() + 5); }, {"edge ", "is open"}},
      {"triangle twice",
       [](TriangleMesh& m) { m.triangles.push_back(m.triangles[9]); },
       {"is shared by 3 triangles", "9", "48"}},
      {"one turned triangle",
       [](TriangleMesh& m) { std::swap(m.triangles[12][0], m.triangles[12][1]); },
       {"triangle 12", "flip triangle 12"}},
      {"unwelded vertex",
       [](TriangleMesh& m) {
         m.vertices.push_back(m.vertices[3] + Vec3(1e-10, 0.0, 0.0));
         for (Triangle& t : m.triangles) {
           for (int& v : t) {
             if (v == 3) {
               v = 26;
               return;
             }
           }
         }
       },
       {"weld vertices 3 and 26", "1e-10"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.defect);
    TriangleMesh mesh = good;
    c.spoil(mesh);
    expect_refusal([&] { check_closed(mesh, "part.obj"); }, c.fragments);
    expect_refusal([&] { check_closed(mesh, "part.obj"); }, {"part.obj: "});
  }
  for (const double bad : {nan, std::numeric_limits<double>::infinity(), 1e200}) {
    TriangleMesh mesh = good;
    mesh.vertices[17].y() = bad;
    expect_refusal([&] { check_closed(mesh); }, {"vertex 17", "finite"});
    expect_refusal([&] { check_surface(mesh); }, {"vertex 17", "finite"});
  }
}

TEST(ClosedMesh, NamesTheFewerTurnedTriangles) {
  TriangleMesh mesh = cube(3);
  for (const int t : {31, 32, 50}) {
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
  }
  expect_refusal([&] { check_closed(mesh); }, {"flip triangle 31 and 2 more (next: 32)"});
}

TEST(ClosedMesh, RefusesABowTie) {
  // Two cubes that share one corner only.
  TriangleMesh mesh = merged(cube(1), moved(cube(1), kUnit));
  int first = -1, second = -1;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if ((mesh.vertices[v] - 0.5 * kUnit).norm() < 1e-12) {
      (first < 0 ? first : second) = v;
    }
  }
  ASSERT_GE(second, 0);
  expect_refusal([&] { check_closed(mesh); },
                 {"weld vertices " + std::to_string(first) + " and " + std::to_string(second)});
  for (Triangle& t : mesh.triangles) {
    for (int& v : t) {
      v = v == second ? first : v > second ? v - 1 : v;
    }
  }
  mesh.vertices.erase(mesh.vertices.begin() + second);
  expect_refusal([&] { check_closed(mesh); }, {"vertex " + std::to_string(first) + " joins two fans"});
  expect_refusal([&] { check_surface(mesh); }, {"vertex " + std::to_string(first) + " joins two fans"});
}

TEST(ClosedMesh, RefusesSliversByAScaleFreeMeasure) {
  // Slide the middle of a box edge towards a corner: the triangles there get thin.
  for (const double scale : {1e-6, 1.0, 1e6}) {
    for (const double gap : {1e-3, 1e-5, 3e-7}) {
      TriangleMesh mesh = moved(cube(2), Vec3::Zero(), scale);
      for (Vec3& x : mesh.vertices) {
        if (x.x() == 0.0 && x.y() < 0.0 && x.z() < 0.0) {
          x.x() = scale * (0.5 - gap);
        }
      }
      if (gap > 1e-5 * 0.9) {
        EXPECT_NO_THROW(check_closed(mesh)) << gap;
      } else {
        expect_refusal([&] { check_closed(mesh); }, {"degenerate", "weld vertices"});
      }
    }
  }
}

TEST(ClosedMesh, RefusesAFlatCapOfATriangle) {
  TriangleMesh mesh = cube(1);
  // A new vertex within 1e-8 of the middle of an edge's line, joined to one of its two triangles.
  const Triangle t = mesh.triangles[0];
  const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
  const Vec3 middle = 0.5 * (a + b);
  mesh.vertices.push_back(middle + 1e-8 * (c - middle));
  const int v = mesh.vertex_count() - 1;
  mesh.triangles[0] = {t[0], t[1], v};
  mesh.triangles.push_back({t[1], t[2], v});
  mesh.triangles.push_back({t[2], t[0], v});
  expect_refusal([&] { check_closed(mesh); },
                 {"triangle 0", "degenerate", "split edge", "vertex " + std::to_string(v)});
}

TEST(ClosedMesh, RefusesTwoSheetsOnEachOther) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  expect_refusal([&] { check_closed(mesh); }, {"shell 0", "encloses"});
}

TEST(ClosedMesh, RefusesAShellCopiedOntoAnother) {
  expect_refusal([] { check_closed(merged(cube(2), cube(2))); }, {"weld vertices 0 and 26"});
}

TEST(ClosedMesh, EverySingleTurnedTriangleIsFound) {
  const TriangleMesh good = sphere(1.0, 1);
  for (int t = 0; t < good.triangle_count(); ++t) {
    TriangleMesh mesh = good;
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
    expect_refusal([&] { check_closed(mesh); }, {"flip triangle " + std::to_string(t)});
  }
}

TEST(OpenSurface, MayHaveBoundaryButNothingElse) {
  TriangleMesh sheet = square_grid(4, 3, 1.0, 1.0);
  const MeshReport report = check_surface(sheet);
  EXPECT_EQ(report.boundary_edges, 14);
  EXPECT_EQ(report.shells, 1);
  EXPECT_NEAR(report.area, 1.0, 1e-14);
  expect_refusal([&] { check_closed(sheet); }, {"is open"});
  std::swap(sheet.triangles[10][0], sheet.triangles[10][1]);
  expect_refusal([&] { check_surface(sheet); }, {"flip triangle 10"});
}

TEST(OpenSurface, RefusesAMoebiusBand) {
  TriangleMesh band;
  const int n = 12;
  for (int k = 0; k < n; ++k) {
    const double angle = 2.0 * M_PI * k / n;
    const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
    const Vec3 across = std::cos(angle / 2) * out + std::sin(angle / 2) * Vec3::UnitZ();
    band.vertices.push_back(out - 0.3 * across);
    band.vertices.push_back(out + 0.3 * across);
  }
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k, b = a + 1;
    const int c = k + 1 < n ? a + 2 : 1, d = k + 1 < n ? a + 3 : 0;
    band.triangles.push_back({a, c, d});
    band.triangles.push_back({a, d, b});
  }
  expect_refusal([&] { check_surface(band); }, {"one side only"});
}

TEST(MeshQuantities, VertexAreasSumToTheArea) {
  const TriangleMesh mesh = sphere(0.7, 2);
  double sum = 0.0;
  for (const double area : vertex_areas(mesh)) {
    EXPECT_GT(area, 0.0);
    sum += area;
  }
  EXPECT_NEAR(sum, surface_area(mesh), 1e-13);
}

TEST(MeshQuantities, AreaVectorsOfAClosedMeshCancel) {
  for (const TriangleMesh& mesh : {prism(7, 3, 2, 0.4, 1.3), sphere(1.0, 2), hollow_sphere(1.0, 0.4, 1)}) {
    Vec3 sum = Vec3::Zero();
    for (int t = 0; t < mesh.triangle_count(); ++t) {
      EXPECT_NEAR(triangle_normal(mesh, t).norm(), 1.0, 1e-14);
      sum += triangle_area(mesh, t) * triangle_normal(mesh, t);
    }
    EXPECT_LT(sum.norm(), 1e-14);
  }
}

TEST(MeshQuantities, UniqueEdgesAreThreeHalvesOfTheTriangles) {
  const TriangleMesh mesh = cube(4);
  const auto edges = unique_edges(mesh);
  EXPECT_EQ(edges.size() * 2, mesh.triangles.size() * 3);
  for (const auto& [a, b] : edges) {
    EXPECT_LT(a, b);
  }
}

TEST(MeshQuantities, VolumeIsInvariantUnderMotionAndTurnsWithAMirror) {
  const TriangleMesh mesh = prism(9, 2, 2, 0.5, 1.0);
  const double volume = signed_volume(mesh);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  EXPECT_NEAR(signed_volume(transformed(mesh, turn, Vec3(1e3, -2e3, 5e2))), volume, 1e-9 * volume);
  EXPECT_NEAR(signed_volume(flipped(mesh)), -volume, 1e-15);
  const TriangleMesh mirrored = transformed(mesh, Vec3(-1.0, 1.0, 1.0).asDiagonal(), Vec3::Zero());
  EXPECT_NEAR(check_closed(mirrored).volume, volume, 1e-14);
}

TEST(MeshChecks, StayQuickOnLargeMeshes) {
  const TriangleMesh mesh = sphere(1.0, 7);
  const MeshReport report = check_closed(mesh);
  EXPECT_EQ(mesh.vertex_count(), 163842);
  EXPECT_NEAR(report.volume, 4.0 / 3.0 * M_PI, 1e-3);
}

TEST(MeshChecks, RandomDamageNeverCrashes) {
  std::mt19937 random(7);
  const TriangleMesh good = hollow_sphere(1.0, 0.5, 1);
  int refused = 0;
  for (int round = 0; round < 2000; ++round) {
    TriangleMesh mesh = good;
    const int hits = 1 + static_cast<int>(random() % 3);
    for (int k = 0; k < hits; ++k) {
      Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
      t[random() % 3] = static_cast<int>(random() % (mesh.vertices.size() + 2)) - 1;
    }
    try {
      check_closed(mesh);
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1900);
}

}  // namespace
}  // namespace softpoint
