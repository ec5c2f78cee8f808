// Closed volumes of bubbles against the thesis' formula and independent integrations.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "air_sheet.h"
#include "softpoint/core/shapes.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::cloth {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(BubbleVolume, OverAPlaneIsThatOfTheThesis) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-1e-3, 1e-3);
  AirSheet sheet(thesis_air(4e-4));
  for (Vec3& x : sheet.positions) x += Vec3(0.05 + shift(random), shift(random), 0.02 + 5 * shift(random));
  sheet.measure(foot_on_plane);
  sheet.find();
  // (3.10): projected area times mean height.
  double sum = 0;
  for (const auto& [a, b, c] : sheet.pattern.faces) {
    const Vec3 &p = sheet.positions[a], &q = sheet.positions[b], &r = sheet.positions[c];
    sum += (q - p).cross(r - p).z() / 2 * (p.z() + q.z() + r.z()) / 3;
  }
  ASSERT_EQ(sheet.pockets(), 1);
  EXPECT_NEAR(sheet.volume(0), sum, 1e-12 * sum);
  EXPECT_NEAR(sheet.finder.bubbles()[0].volume, sum, 1e-12 * sum);
  // All of the border closes it, 4 * 49 edges; the air is what was asked for.
  EXPECT_EQ(sheet.finder.rims().size(), 4u * 49);
  EXPECT_DOUBLE_EQ(sheet.air(0), 101325 * 4e-4);
}

TEST(BubbleVolume, OfAPistonKeepsPressureTimesVolume) {
  AirSheet sheet(thesis_air(4e-4));
  const double height = 4e-4 / 0.09;
  sheet.lift([&](double, double) { return height; });
  sheet.find();
  EXPECT_NEAR(sheet.air(0) / sheet.volume(0), 101325, 1e-6 * 101325);
  for (int i = 1; i <= 100; ++i) {  // slowly down to half the height
    sheet.lift([&](double, double) { return height * (1 - 0.005 * i); });
    sheet.find();
    sheet.exchange(1.0 / 60);
    EXPECT_NEAR(sheet.air(0), 101325 * 4e-4, 1e-6 * 101325 * 4e-4);
  }
  EXPECT_NEAR(sheet.air(0) / sheet.volume(0), 202650, 1e-6 * 202650);
}

// A solid round the origin, seen from there: distance to its surface along a unit vector, and its nearest
// points.
struct Solid {
  std::function<double(const Vec3&)> radius;
  Nearest nearest;
};

Solid ball(double r) {
  return {[r](const Vec3&) { return r; },
          [r](const Vec3& x) {
            const Vec3 n = x.normalized();
            return Foot{r * n, n, x.norm() - r};
          }};
}

Solid box(const Vec3& half) {
  return {[half](const Vec3& d) { return half.cwiseQuotient(d.cwiseAbs().cwiseMax(1e-300)).minCoeff(); },
          [half](const Vec3& x) {
            Vec3 p = x.cwiseMax(-half).cwiseMin(half);
            const Vec3 away = x - p;
            if (away.norm() > 1e-12) return Foot{p, away.normalized(), away.norm()};
            int axis = 0;  // inside or on it: the nearest side
            (half - x.cwiseAbs()).minCoeff(&axis);
            const Vec3 n = Vec3::Unit(axis) * (x[axis] < 0 ? -1.0 : 1.0);
            p[axis] = n[axis] * half[axis];
            return Foot{p, n, (x - p).dot(n)};
          }};
}

Solid capsule(double r, double half) {  // along x
  const auto axis_point = [half](const Vec3& x) { return Vec3(std::clamp(x.x(), -half, half), 0, 0); };
  return {[r, half](const Vec3& d) {
            const double side = r / std::sqrt(std::max(1 - d.x() * d.x(), 1e-300));
            if (std::abs(side * d.x()) <= half) return side;
            const double c = half * std::abs(d.x());
            return c + std::sqrt(c * c + r * r - half * half);
          },
          [r, axis_point](const Vec3& x) {
            const Vec3 p = axis_point(x), n = (x - p).normalized();
            return Foot{p + r * n, n, (x - p).norm() - r};
          }};
}

// The sheet wraps the upper part of the solid and stands off it by a bump that ends before the border; the
// volume under the bump is the integral of (outer^3 - inner^3)/3 over the directions.
void expect_volume(const Solid& solid, double spread, double height) {
  AirSheet sheet(sealed(), 50, 2);  // u and v from -1 to 1
  const auto direction = [&](double u, double v) { return Vec3(spread * u, spread * v, 1).normalized(); };
  const auto stand_off = [&](double u, double v) { return bump(u, v, height, 0.9); };
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    const Vec3& at = sheet.pattern.points[i];
    const Vec3 d = direction(at.x(), at.y());
    sheet.positions[i] = (solid.radius(d) + stand_off(at.x(), at.y())) * d;
  }
  sheet.measure(solid.nearest);
  sheet.find();
  ASSERT_EQ(sheet.pockets(), 1);

  double integral = 0;
  const int n = 1000;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double u = -1 + (2 * i + 1.0) / n, v = -1 + (2 * j + 1.0) / n;
      const Vec3 d = direction(u, v);
      const double inner = solid.radius(d), outer = inner + stand_off(u, v);
      integral += (outer * outer * outer - inner * inner * inner) / 3 * d.z() * d.z() * d.z();
    }
  }
  integral *= spread * spread * 4.0 / (n * n);
  const double volume = sheet.volume(0);
  std::printf("[ volume   ] %.3f cm3, %+.3f %% from the integral\n", volume * 1e6,
              (volume / integral - 1) * 100);
  EXPECT_NEAR(volume, integral, 0.01 * integral);
  EXPECT_NEAR(sheet.finder.bubbles()[0].volume, volume, 1e-12 * volume);
}

TEST(BubbleVolume, OverABallAgreesWithTheIntegral) { expect_volume(ball(0.15), 1.2, 0.02); }
TEST(BubbleVolume, OverABoxAgreesWithTheIntegral) {
  expect_volume(box({0.12, 0.1, 0.1}), 0.7, 0.02);  // its top alone
  expect_volume(box({0.12, 0.1, 0.1}), 1.6, 0.03);  // down its sides, over edges and corners
}
TEST(BubbleVolume, OverACapsuleAgreesWithTheIntegral) {
  expect_volume(capsule(0.1, 0.05), 1.2, 0.02);
  expect_volume(capsule(0.06, 0.12), 1.5, 0.02);
}

TEST(BubbleVolume, OfAClosedClothIsThatOfItsFaces) {
  const TriangleMesh mesh = sphere(0.1, 3);
  AirSettings settings;
  BubbleFinder finder(make_air_topology(mesh.vertices, mesh.triangles), settings);
  std::vector<Vec3> positions(mesh.vertices.begin(), mesh.vertices.end());
  for (Vec3& x : positions) x += Vec3(0.3, 0, 0.1);
  // It is dry, and it lies on a plane: its bottom touches, and it still has one bubble.
  std::vector<Vec3> feet, normals(positions.size(), Vec3::UnitZ());
  std::vector<double> gaps;
  for (const Vec3& x : positions) {
    feet.push_back(foot_on_plane(x).point);
    gaps.push_back(x.z());
  }
  EXPECT_TRUE(finder.find({positions, feet, normals, gaps}));
  ASSERT_EQ(finder.pockets().size(), 1u);
  EXPECT_TRUE(finder.rims().empty());
  EXPECT_EQ(finder.pockets()[0].closure, 0);
  EXPECT_FALSE(finder.pockets()[0].open);
  EXPECT_NEAR(finder.volume(0, positions), signed_volume(mesh), 1e-12);
  EXPECT_NEAR(finder.volume(0, positions), 4 * kPi / 3 * 1e-3, 0.03 * 4 * kPi / 3 * 1e-3);
  EXPECT_NEAR(finder.pockets()[0].air, 101325 * signed_volume(mesh), 1e-6);
  settings.initial_volume = 5e-3;  // blown up
  BubbleFinder full(make_air_topology(mesh.vertices, mesh.triangles), settings);
  full.find({positions, feet, normals, gaps});
  EXPECT_NEAR(full.pockets()[0].air, 101325 * 5e-3, 1e-9);
}

TEST(BubbleVolume, OfAClothThatLiesFaceDownIsPositiveToo) {
  AirSheet sheet(sealed());
  // Turned over about the x axis.
  for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
    const Vec3& at = sheet.pattern.points[i];
    sheet.positions[i] = Vec3(at.x(), -at.y(), bump(at.x(), at.y(), 0.02, 0.1));
  }
  sheet.measure(foot_on_plane);
  sheet.find();
  ASSERT_EQ(sheet.pockets(), 1);
  EXPECT_EQ(sheet.finder.pockets()[0].side, -1);
  EXPECT_NEAR(sheet.volume(0), 0.02 * kPi * 0.01 / 3, 0.01 * 0.02 * kPi * 0.01 / 3);
}

TEST(BubbleVolume, ThatIsNegativeIsFlaggedAndKeepsItsAir) {
  AirSheet sheet(sealed());
  sheet.lift([](double x, double y) { return bump(x, y, 0.02, 0.1); });
  sheet.find();
  const double air = sheet.air(0);
  sheet.lift([](double x, double y) { return -bump(x, y, 0.02, 0.1); });
  for (double& gap : sheet.gaps) gap = std::abs(gap);  // folded through, not in contact
  sheet.find();
  ASSERT_EQ(sheet.pockets(), 1);
  EXPECT_TRUE(sheet.finder.bubbles()[0].folded);
  EXPECT_EQ(sheet.finder.counts().folded, 1);
  EXPECT_DOUBLE_EQ(sheet.air(0), air);
  EXPECT_FALSE(sheet.finder.pockets()[0].open);
}

TEST(BubbleVolume, FeetFeelTheOppositeOfTheCloth) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> shift(-2e-3, 2e-3);
  const Solid solid = ball(0.3);
  for (int trial = 0; trial < 10; ++trial) {
    AirSheet sheet(sealed());
    for (Vec3& x : sheet.positions) {
      const double height = bump(x.x(), x.y(), 0.03, 0.12);
      x.z() = std::sqrt(0.09 - x.x() * x.x() - x.y() * x.y()) + height;
      if (height > 2e-3) x += Vec3(shift(random), shift(random), shift(random));
    }
    sheet.measure(solid.nearest);
    sheet.find();
    ASSERT_GE(sheet.pockets(), 1);
    const std::vector<double> gauges(sheet.pockets(), -1234.5);
    std::vector<Vec3> forces(sheet.positions.size(), Vec3::Zero());
    sheet.finder.add_foot_forces(sheet.frame(), gauges, forces);
    Vec3 on_feet = Vec3::Zero();
    for (const Vec3& force : forces) on_feet += force;
    // V is linear in a shift of the whole cloth: its change is gauge * dV/dx.
    Vec3 on_cloth = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      for (const double step : {-0.01, 0.01}) {
        std::vector<Vec3> moved = sheet.positions;
        for (Vec3& x : moved) x[k] += step;
        for (int i = 0; i < sheet.pockets(); ++i) {
          on_cloth[k] += gauges[i] * sheet.finder.volume(i, moved) / (2 * step);
        }
      }
    }
    EXPECT_GT(on_cloth.norm(), 1);
    EXPECT_LT((on_feet + on_cloth).norm(), 1e-9 * on_cloth.norm());
  }
}

}  // namespace
}  // namespace softpoint::cloth
