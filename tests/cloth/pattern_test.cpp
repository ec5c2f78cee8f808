#include "softpoint/cloth/pattern.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"

namespace {

using namespace softpoint;
using namespace softpoint::cloth;

// Energy per area of the springs under a small homogeneous strain (xx, yy, xy).
double energy_density(const ClothPattern& pattern, double area, double xx, double yy, double xy) {
  double sum = 0;
  for (const Spring& spring : pattern.springs) {
    const Vec3 d = pattern.points[spring.b] - pattern.points[spring.a];
    const double longer = (xx * d.x() * d.x() + yy * d.y() * d.y() + 2 * xy * d.x() * d.y()) / spring.rest;
    sum += 0.5 * spring.stiffness * longer * longer;
  }
  return sum / area;
}

// Plane stress, Poisson's ratio 1/3.
double membrane_density(double membrane, double xx, double yy, double xy) {
  return 0.5 * membrane / (1 - 1. / 9) * (xx * xx + yy * yy + 2. / 3 * xx * yy + 4. / 3 * xy * xy);
}

// 1 x 0.866 m, with a ragged border.
TriangleMesh equilateral_sheet() {
  TriangleMesh sheet = square_grid(40, 40, 1, 1);
  for (Vec3& v : sheet.vertices) {
    const int row = static_cast<int>(std::lround((v.y() + 0.5) * 40));
    v.x() += (row % 2) * 0.0125;
    v.y() *= std::sqrt(3) / 2;
  }
  for (int f = 0; f < sheet.triangle_count(); f += 2) {
    Triangle& t = sheet.triangles[f];
    Triangle& u = sheet.triangles[f + 1];
    const int cell = f / 2, i = cell % 40, j = cell / 40;
    const int a = j * 41 + i, b = a + 1, d = a + 41, c = d + 1;
    if (j % 2 == 0) {
      t = {a, b, d}, u = {b, c, d};
    } else {
      t = {a, b, c}, u = {a, c, d};
    }
  }
  return sheet;
}

TEST(ClothPattern, SquareHasSpringsToEightNeighboursAndItsMass) {
  const Fabric fabric;
  for (Lumping lumping : {Lumping::kArea, Lumping::kEqual}) {
    const ClothPattern p = square_pattern(7, 5, 0.6, 0.4, fabric, lumping);
    check(p);
    EXPECT_EQ(p.point_count(), 35);
    EXPECT_EQ(p.faces.size(), 48u);
    EXPECT_EQ(p.springs.size(), 6u * 5 + 7 * 4 + 2 * 6 * 4);
    double mass = 0, area = 0;
    for (double m : p.masses) mass += m;
    for (const Triangle& f : p.faces) {
      const Vec3 normal = (p.points[f[1]] - p.points[f[0]]).cross(p.points[f[2]] - p.points[f[0]]);
      EXPECT_GT(normal.z(), 0);
      area += normal.norm() / 2;
    }
    EXPECT_NEAR(area, 0.24, 1e-15);
    EXPECT_NEAR(mass, 0.24 * fabric.area_density, 1e-15);
    EXPECT_NEAR(p.spacing, 0.1, 1e-15);
  }
}

TEST(ClothPattern, GridStretchesLikeAMembraneWhenDiagonalsAreHalf) {
  Fabric fabric;
  fabric.shear_stiffness = fabric.warp_stiffness / 2;
  const ClothPattern p = square_pattern(201, 201, 1, 1, fabric);
  const double membrane = 4. / 3 * fabric.warp_stiffness;
  const double strains[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -0.4, 0.7}};
  for (const auto& e : strains) {
    const double expected = membrane_density(membrane, e[0], e[1], e[2]);
    EXPECT_NEAR(energy_density(p, 1, e[0], e[1], e[2]), expected, 0.006 * expected);  // the border is finite
  }
}

// A flat mesh of any shape and one of right triangles: springs of the same membrane.
TEST(ClothPattern, MeshStretchesLikeTheSameMembrane) {
  Fabric fabric;
  const double membrane = 4. / 3 * fabric.warp_stiffness;
  const double strains[4][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, -0.4, 0.7}};
  const ClothPattern right = mesh_pattern(square_grid(40, 40, 1, 1), fabric);
  check(right);
  const ClothPattern skewed = mesh_pattern(equilateral_sheet(), fabric);
  for (const auto& e : strains) {
    const double expected = membrane_density(membrane, e[0], e[1], e[2]);
    EXPECT_NEAR(energy_density(right, 1, e[0], e[1], e[2]), expected, 0.05 * expected);
    EXPECT_NEAR(energy_density(skewed, std::sqrt(3) / 2, e[0], e[1], e[2]), expected, 0.02 * expected);
  }
}

// A cylinder's curvature 1/R costs B/(2 R^2) an area; a flat sheet nothing, however it lies.
TEST(ClothPattern, BendingIsThatOfAPlate) {
  Fabric fabric;
  fabric.bending_stiffness = 1e-4;
  const double radius = 1.5;
  const auto bending_energy = [](const ClothPattern& p, const std::vector<Vec3>& x) {
    double sum = 0;
    for (const BendElement& bend : p.bends) {
      Vec3 turn = Vec3::Zero();
      for (int k = 0; k < 4; ++k) turn += bend.weight[k] * x[bend.point[k]];
      sum += 0.5 * bend.stiffness * turn.squaredNorm();
    }
    return sum;
  };
  for (const ClothPattern& p :
       {square_pattern(41, 41, 1, 1, fabric), mesh_pattern(equilateral_sheet(), fabric)}) {
    const double area = p.columns > 0 ? 1 : std::sqrt(3) / 2;
    check(p);
    std::vector<Vec3> rolled;
    for (const Vec3& v : p.points) {
      rolled.push_back({radius * std::sin(v.x() / radius), v.y(), radius * (1 - std::cos(v.x() / radius))});
    }
    const double expected = 0.5 * fabric.bending_stiffness / (radius * radius) * area;
    EXPECT_NEAR(bending_energy(p, rolled), expected, 0.05 * expected);
    EXPECT_LT(bending_energy(p, p.points), 1e-12 * expected);
  }
}

TEST(ClothPattern, RefusesWhatIsOutOfRange) {
  const Fabric fabric;
  EXPECT_THROW(square_pattern(1, 5, 1, 1, fabric), Error);
  EXPECT_THROW(square_pattern(5, 5, 0, 1, fabric), Error);
  EXPECT_THROW(square_pattern(5, 5, 1, NAN, fabric), Error);
  Fabric bad = fabric;
  bad.compression_ratio = 1.5;
  EXPECT_THROW(square_pattern(5, 5, 1, 1, bad), Error);
  bad = fabric;
  bad.weft_stiffness = 1;
  EXPECT_THROW(mesh_pattern(square_grid(4, 4, 1, 1), bad), Error);
  ClothPattern pattern = square_pattern(3, 3, 1, 1, fabric);
  pattern.springs[0].b = 9;
  EXPECT_THROW(check(pattern), Error);
}

}  // namespace
