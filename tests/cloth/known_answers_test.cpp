#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "softpoint/core/shapes.h"
#include "support/precision.h"
#include "support/solver_sheet.h"

// The solver beside answers in closed form. Single precision is held to five times the tolerance of double.
namespace softpoint::cloth {
namespace {

class KnownAnswers : public testing::TestWithParam<Precision> {
 protected:
  static double slack(double tolerance) {
    return GetParam() == Precision::kDouble ? tolerance : 5 * tolerance;
  }
  static ClothSettings settings() {
    ClothSettings settings = settings_of(Dial::kDefault);
    settings.precision = GetParam();
    return settings;
  }
};

// E h = 4 k/3 and Poisson's ratio 1/3.
Fabric isotropic(double spring) {
  Fabric fabric = reference_fabric();
  fabric.warp_stiffness = fabric.weft_stiffness = spring;
  fabric.shear_stiffness = spring / 2;
  fabric.compression_ratio = 1;
  return fabric;
}

double projected_area(const ClothPattern& pattern, const std::vector<Vec3>& x) {
  double area = 0;
  for (const Triangle& t : pattern.faces) area += 0.5 * (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).z();
  return area;
}

std::vector<int> border(const ClothPattern& pattern) {
  std::vector<int> points;
  for (int p = 0; p < pattern.point_count(); ++p) {
    const int i = p % pattern.columns, j = p / pattern.columns;
    if (i == 0 || j == 0 || i + 1 == pattern.columns || j + 1 == pattern.rows) points.push_back(p);
  }
  return points;
}

TEST_P(KnownAnswers, FlatSheetRestsOnItsAir) {
  Fabric fabric = reference_fabric();
  fabric.drag_rate = 30;
  SolverSheet sheet(square_pattern(50, 50, 0.3, 0.3, fabric), fabric, settings());
  std::vector<Vec3> start = sheet.positions;
  for (Vec3& x : start) x.z() = 400e-6 / 0.09;
  sheet.place(start);
  sheet.floor_friction = 0.4;
  sheet.seal(400e-6);
  for (int k = 0; k < 60; ++k) sheet.step(1.0 / 60);
  EXPECT_NEAR(sheet.gauge(), 0.018 * 9.8 / 0.09, slack(0.02) * 1.96);
}

TEST_P(KnownAnswers, SuctionCup) {
  const Fabric fabric = reference_fabric();
  SolverSheet sheet(square_pattern(50, 50, 0.3, 0.3, fabric), fabric, settings());
  sheet.place(sheet.positions);
  sheet.floor_friction = 0.4;
  sheet.seal(0);
  const ClothPattern& pattern = sheet.solver.pattern();
  const std::vector<int> rim = border(pattern);
  for (int k = 1; k <= 40; ++k) {
    sheet.hands.clear();
    for (int p : rim) sheet.hands.push_back({p, pattern.points[p], Vec3::Zero(), INFINITY});
    const double lift = 0.01 * std::min(1.0, k / 30.0);
    sheet.hands.push_back({pattern.columns * 25 + 25,
                           pattern.points[pattern.columns * 25 + 25] + Vec3(0, 0, lift),
                           Vec3(0, 0, k < 30 ? 0.02 : 0), INFINITY});
    sheet.step(1.0 / 60);
  }
  double held = sheet.floor_force().z();
  for (std::size_t h = 0; h < sheet.hands.size(); ++h)
    held += sheet.solver.hand_force(static_cast<int>(h)).z();
  EXPECT_GT(sheet.solver.hand_force(static_cast<int>(rim.size())).z(), 10);  // the centre is pulled
  EXPECT_NEAR(held - 0.018 * 9.8, 9119, slack(0.005) * 9119);
}

// Points outside the circle are held; the grid is fine enough for the steps of its rim to average out.
TEST_P(KnownAnswers, HenckysClampedCircle) {
  const double a = 0.15, spring = 1e4;
  const Fabric fabric = isotropic(spring);
  const int n = 61;
  const double spacing = 2 * a / (n - 3);
  Fabric damped = fabric;
  damped.drag_rate = 60;
  const ClothPattern pattern = square_pattern(n, n, spacing * (n - 1), spacing * (n - 1), damped);
  for (const double pressure : {20.0, 100.0}) {
    SolverSheet sheet(pattern, damped, settings());
    sheet.solver.set_gravity(Vec3::Zero());
    std::vector<int> faces(pattern.faces.size(), 0);
    AirPocket pocket;
    pocket.closure = 1e4;
    pocket.air = (pocket.ambient + pressure) * pocket.closure;
    // Half a cell inwards: the ring of points nearest to the circle lies on both sides of it.
    for (int p = 0; p < pattern.point_count(); ++p) {
      if (pattern.points[p].norm() > a - spacing / 2)
        sheet.hands.push_back({p, pattern.points[p], Vec3::Zero(), INFINITY});
    }
    sheet.solver.set_air(faces, {&pocket, 1}, {});
    for (int k = 0; k < 40; ++k) sheet.step(1.0 / 60);
    const double expected = 0.64478 * a * std::cbrt(pressure * a / (4 * spring / 3));
    const double rise = sheet.positions[static_cast<std::size_t>(n / 2 * n + n / 2)].z();
    EXPECT_NEAR(rise, expected, slack(0.015) * expected) << pressure;
  }
}

TEST_P(KnownAnswers, BalloonFilledBeyondItsVolume) {
  Fabric fabric = isotropic(1e4);
  fabric.drag_rate = 30;
  const TriangleMesh ball = softpoint::sphere(0.1, 4);
  const ClothPattern pattern = mesh_pattern(ball, fabric);
  SolverSheet sheet(pattern, fabric, settings());
  sheet.solver.set_gravity(Vec3::Zero());
  const std::vector<int> faces(pattern.faces.size(), 0);
  AirPocket pocket;
  pocket.air = 1.05 * pocket.ambient * signed_volume(ball);
  sheet.solver.set_air(faces, {&pocket, 1}, {});
  for (int k = 0; k < 60; ++k) sheet.step(1.0 / 60);
  EXPECT_NEAR(sheet.gauge(), 2835, slack(0.02) * 2835);
  double radius = 0;
  for (const Vec3& x : sheet.positions) radius += x.norm() / static_cast<double>(sheet.positions.size());
  EXPECT_NEAR(radius / 0.1 - 1, 0.00709, slack(0.02) * 0.00709);
}

// Without diagonals each column of springs hangs alone: its discrete and its continuous answer are the same.
TEST_P(KnownAnswers, HangingStrip) {
  Fabric fabric = reference_fabric();
  fabric.warp_stiffness = fabric.weft_stiffness = 200;
  fabric.shear_stiffness = 0;
  fabric.compression_ratio = 1;
  fabric.drag_rate = 20;
  const int columns = 4, rows = 61;
  const double length = 0.6, width = length / (rows - 1) * (columns - 1);
  SolverSheet sheet(square_pattern(columns, rows, width, length, fabric, Lumping::kEqual), fabric,
                    settings());
  sheet.solver.set_gravity({0, -9.8, 0});
  const auto& points = sheet.solver.pattern().points;
  const int top = columns * (rows - 1);
  for (int i = 0; i < columns; ++i) sheet.hands.push_back({top + i, points[top + i], Vec3::Zero(), INFINITY});
  for (int k = 0; k < 120; ++k) sheet.step(1.0 / 60);
  const double stiffness = 200.0 * columns / (columns - 1);  // E h: the border's springs count in full
  const double expected = fabric.area_density * 9.8 * length * length / (2 * stiffness);
  for (int i = 0; i < columns; ++i) {
    EXPECT_NEAR(points[i].y() - sheet.positions[i].y(), expected, slack(0.01) * expected) << i;
  }
}

TEST_P(KnownAnswers, InclineHoldsAndSlidesByCoulombsCoefficient) {
  for (const double degrees : {21.6, 22.0}) {
    const Fabric fabric = reference_fabric();
    SolverSheet sheet(square_pattern(15, 15, 0.09, 0.09, fabric), fabric, settings());
    sheet.floor_friction = 0.4;
    const double angle = degrees * M_PI / 180;
    sheet.solver.set_gravity({9.8 * std::sin(angle), 0, -9.8 * std::cos(angle)});
    for (int k = 0; k < 600; ++k) sheet.step(1.0 / 60);
    Vec3 moved = Vec3::Zero();
    double most = 0;
    for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
      const Vec3 way = sheet.positions[i] - sheet.solver.pattern().points[i];
      moved += way / static_cast<double>(sheet.positions.size());
      most = std::max(most, way.norm());
    }
    if (degrees < 21.8) {
      EXPECT_LT(most, slack(1e-5));
    } else {
      // with drag c the way is a (t/c - (1 - exp(-c t))/c^2)
      const double pull = 9.8 * (std::sin(angle) - 0.4 * std::cos(angle));
      const double expected = pull * (10 - (1 - std::exp(-10.0)));
      EXPECT_NEAR(moved.x(), expected, slack(0.05) * expected);
      EXPECT_LT(std::abs(moved.y()), slack(1e-4));
    }
  }
}

TEST_P(KnownAnswers, TentAtRestIsInBalance) {
  LiftTask task = centre_lift();
  task.height = 0.05, task.lift_time = 0.5, task.hold_time = 1;
  // The rim never quite comes to rest on its air (some mm/s): means over the last half second.
  double hand = 0, floor = 0, air = 0;
  constexpr int kMean = 30;
  const auto note = [&](SolverSheet& sheet, int frame) {
    if (frame <= task.frames() - kMean) return;
    hand += sheet.solver.hand_force(0).z() / kMean;
    floor += sheet.floor_force().z() / kMean;
    air -= sheet.gauge() * projected_area(sheet.solver.pattern(), sheet.positions) / kMean;
  };
  solver_lift(task, settings(), note);
  const double weight = LiftTask::kMass * LiftTask::kGravity;
  EXPECT_GT(hand, 0.1 * weight);  // 0.16 to 0.45 by how friction leaves it, in fine-step runs too
  EXPECT_NEAR(hand + floor, weight + air, slack(0.01) * (weight + std::abs(air)));
}

TEST_P(KnownAnswers, VacuumLift) {
  const ClothRun run = solver_lift(vacuum_lift(), settings());
  EXPECT_NEAR(run.back().force, 156.94, slack(0.01) * 156.94);
  EXPECT_NEAR(run.back().max_stretch, 0.5213, slack(0.01) * 0.5213);
}

TEST_P(KnownAnswers, EnergyNeverRisesWithFixedPins) {
  Fabric fabric = reference_fabric();
  fabric.drag_rate = 0;
  SolverSheet sheet(square_pattern(30, 30, 0.3, 0.3, fabric), fabric, settings());
  const auto& points = sheet.solver.pattern().points;
  for (int p : {0, 29})
    sheet.hands.push_back({p, points[static_cast<std::size_t>(p)], Vec3::Zero(), INFINITY});
  const auto energy = [&] { return sheet.solver.kinetic_energy() + sheet.solver.potential_energy(); };
  double before = energy();
  const double scale = 0.018 * 9.8 * 0.3;
  for (int k = 0; k < 120; ++k) {
    sheet.step(1.0 / 60);
    const double now = energy();
    EXPECT_LT(now - before, slack(1e-6) * scale) << k;
    before = now;
  }
  EXPECT_LT(before, -0.1 * scale);  // it has swung down
}

INSTANTIATE_TEST_SUITE_P(BothPrecisions, KnownAnswers,
                         testing::Values(Precision::kDouble, Precision::kSingle), [](const auto& tested) {
                           return std::string(tested.param == Precision::kDouble ? "Double" : "Single");
                         });

}  // namespace
}  // namespace softpoint::cloth
