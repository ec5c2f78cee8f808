#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cstdlib>
#include <optional>

#include "softpoint/core/error.h"
#include "support/paper_lift.h"
#include "support/precision.h"
#include "support/tier.h"

// The `paper` mode: its forms agree, and it gives the fine-step reference runs again.
namespace softpoint::cloth {
namespace {

std::string data(const std::string& name) { return SOFTPOINT_CLOTH_DATA "/" + name + ".csv"; }

PaperSettings variant(bool simd, Precision precision, PaperPressure pressure, PaperFriction friction,
                      double step) {
  PaperSettings settings;
  settings.simd = simd;
  settings.precision = precision;
  settings.pressure = pressure;
  settings.friction = friction;
  settings.step = step;
  return settings;
}

double farthest(const PaperCloth& a, const PaperCloth& b) {
  double most = 0;
  for (int i = 0; i < a.point_count(); ++i)
    most = std::max(most, (a.positions()[i] - b.positions()[i]).norm());
  return most;
}

// A bumpy sheet pressed onto the plane, lifted and rubbed: everything is at work.
PaperCloth bumpy(const PaperSettings& settings) {
  Fabric fabric = reference_fabric();
  fabric.warp_stiffness = 6e3;
  PaperCloth cloth(square_pattern(13, 9, 0.08, 0.06, fabric), fabric, settings);
  std::vector<Vec3> x = cloth.pattern().points, v(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i].z() = 0.002 + 0.0015 * std::sin(300 * x[i].x()) * std::cos(170 * x[i].y());
    v[i] = Vec3(0.5, 0.2, -1 + 20 * x[i].x());
  }
  cloth.set_state(x, v);
  cloth.set_air(10e-6);
  const Vec3 lift = x[60] + Vec3(0.001, 0, 0.004);
  cloth.set_hands(std::vector<PaperHand>{{60, lift, Vec3(0, 0, 1)}});
  return cloth;
}

TEST(Paper, SimdFormsGiveWhatTheObviousOneGives) {
  for (const PaperPressure pressure : {PaperPressure::kConstantArea, PaperPressure::kVolumeGradient}) {
    for (const PaperFriction friction : {PaperFriction::kForces, PaperFriction::kImpulse}) {
      PaperCloth slow = bumpy(variant(false, Precision::kDouble, pressure, friction, 1e-6));
      PaperCloth fast = bumpy(variant(true, Precision::kDouble, pressure, friction, 1e-6));
      PaperCloth single = bumpy(variant(true, Precision::kSingle, pressure, friction, 1e-6));
      const std::vector<Vec3> start = slow.positions();
      for (PaperCloth* cloth : {&slow, &fast, &single}) EXPECT_EQ(cloth->step(2e-3), 2000);
      double moved = 0;
      for (std::size_t i = 0; i < start.size(); ++i)
        moved = std::max(moved, (slow.positions()[i] - start[i]).norm());
      EXPECT_GT(moved, 1e-3);
      EXPECT_LT(farthest(slow, fast), 1e-10) << static_cast<int>(pressure) << static_cast<int>(friction);
      EXPECT_LT(farthest(slow, single), 2e-5) << static_cast<int>(pressure) << static_cast<int>(friction);
      EXPECT_NEAR(slow.gauge(), fast.gauge(), 1e-5 * std::abs(slow.gauge()));
      EXPECT_GT(std::abs(slow.gauge()), 10.0);  // the air is at work
    }
  }
}

TEST(Paper, InstructionSetsAgree) {
  const PaperSettings settings =
      variant(true, Precision::kDouble, PaperPressure::kVolumeGradient, PaperFriction::kImpulse, 1e-6);
  std::optional<std::string> before;
  if (const char* value = std::getenv("SOFTPOINT_MAX_ISA")) before = value;
  std::vector<PaperCloth> cloths;
  for (const char* set : {"baseline", "avx2", "avx512"}) {
    setenv("SOFTPOINT_MAX_ISA", set, 1);
    cloths.push_back(bumpy(settings));
    cloths.back().step(1e-3);
  }
  before ? setenv("SOFTPOINT_MAX_ISA", before->c_str(), 1) : unsetenv("SOFTPOINT_MAX_ISA");
  EXPECT_LT(farthest(cloths[0], cloths[1]), 1e-10);
  EXPECT_LT(farthest(cloths[0], cloths[2]), 1e-10);
}

// The same over a plane that lies anywhere.
TEST(Paper, PlanesAreAllAlike) {
  const PaperSettings settings =
      variant(true, Precision::kDouble, PaperPressure::kVolumeGradient, PaperFriction::kImpulse, 1e-6);
  PaperCloth level = bumpy(settings), turned = bumpy(settings);
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vec3 foot(3, -1, 2);
  std::vector<Vec3> x = turned.positions(), v = turned.velocities();
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = turn * x[i] + foot, v[i] = turn * v[i];
  turned.set_plane(turn * Vec3::UnitZ(), foot);
  turned.set_state(x, v);
  turned.set_gravity(turn * Vec3(0, 0, -9.8));
  const Vec3 lift = x[60] + turn * Vec3(0.001, 0, 0.004);
  turned.set_hands(std::vector<PaperHand>{{60, lift, turn * Vec3(0, 0, 1)}});
  level.step(1e-3);
  turned.step(1e-3);
  double most = 0;
  for (int i = 0; i < level.point_count(); ++i) {
    most = std::max(most, (turn * level.positions()[i] + foot - turned.positions()[i]).norm());
  }
  EXPECT_LT(most, 1e-8);
  EXPECT_NEAR(level.volume(), turned.volume(), 1e-6 * level.volume());
  EXPECT_LT((turn * level.hand_force(60) - turned.hand_force(60)).norm(), 1e-4 * level.hand_force(60).norm());
}

// As printed, (3.7) presses flat cloth under suction down, never up.
TEST(Paper, SuctionPullsTowardsThePlane) {
  for (const PaperPressure pressure : {PaperPressure::kConstantArea, PaperPressure::kVolumeGradient}) {
    const Fabric fabric = reference_fabric();
    PaperCloth cloth(reference_pattern(20, fabric), fabric,
                     variant(true, Precision::kDouble, pressure, PaperFriction::kForces, 1e-6));
    std::vector<Vec3> x = cloth.pattern().points;
    for (Vec3& p : x) p.z() = 0.005;
    cloth.set_state(x, std::vector<Vec3>(x.size(), Vec3::Zero()));
    cloth.set_gravity(Vec3::Zero());
    cloth.set_air(0.9 * cloth.volume());
    cloth.step(2e-5);
    EXPECT_LT(cloth.gauge(), -5e3);
    for (const Vec3& v : cloth.velocities()) EXPECT_LT(v.z(), 0);
  }
}

// Constant S: a flat sheet that the air carries stays flat, at m g/A over the ambient pressure.
TEST(Paper, FlatSheetRestsOnItsAir) {
  Fabric fabric = reference_fabric();
  fabric.drag_rate = 20;
  PaperCloth cloth(
      reference_pattern(20, fabric), fabric,
      variant(true, Precision::kDouble, PaperPressure::kConstantArea, PaperFriction::kForces, 4e-6));
  std::vector<Vec3> x = cloth.pattern().points;
  for (Vec3& p : x) p.z() = 400e-6 / 0.09;
  cloth.set_state(x, std::vector<Vec3>(x.size(), Vec3::Zero()));
  cloth.set_air(400e-6);
  cloth.step(0.5);
  EXPECT_NEAR(cloth.gauge(), LiftTask::kMass * 9.8 / 0.09, 0.02 * 1.96);
  double low = 1, high = 0;
  for (const Vec3& p : cloth.positions()) low = std::min(low, p.z()), high = std::max(high, p.z());
  EXPECT_LT(high - low, 1e-9);
}

// Two layers of a fold fall onto each other.
PaperCloth folded(bool simd, double diameter) {
  Fabric fabric = reference_fabric();
  fabric.warp_stiffness = fabric.weft_stiffness = 1e3;
  fabric.shear_stiffness = 250;
  PaperSettings settings =
      variant(simd, Precision::kDouble, PaperPressure::kConstantArea, PaperFriction::kForces, 1e-5);
  settings.sphere_diameter = diameter;
  settings.sphere_friction = 0.3;
  PaperCloth cloth(square_pattern(20, 10, 0.1, 0.05, fabric), fabric, settings);
  std::vector<Vec3> x = cloth.pattern().points;
  const double r = 4e-3, half = 0.5 * M_PI * r;
  for (Vec3& p : x) {
    const double s = p.x(), angle = std::clamp(s, -half, half) / r;
    p.x() = std::max(std::abs(s) - half, 0.0) - r * std::cos(angle);
    p.z() = r + r * std::sin(angle);
  }
  cloth.set_state(x, std::vector<Vec3>(x.size(), Vec3::Zero()));
  cloth.set_air_on(false);
  return cloth;
}

double nearest_points(const PaperCloth& cloth) {
  double nearest = 1;
  const int columns = cloth.pattern().columns;
  for (int a = 0; a < cloth.point_count(); ++a) {
    for (int b = a + 1; b < cloth.point_count(); ++b) {
      if (std::abs(a % columns - b % columns) <= 1 && std::abs(a / columns - b / columns) <= 1) continue;
      const double distance = (cloth.positions()[a] - cloth.positions()[b]).norm();
      if (!(distance >= nearest)) nearest = distance;  // and NaN
    }
  }
  return nearest;
}

TEST(Paper, SpheresKeepAFoldApart) {
  for (const bool simd : {false, true}) {
    PaperCloth with = folded(simd, 4e-3), without = folded(simd, 0);
    double apart = 1, through = 1;
    for (int k = 0; k < 12; ++k) {
      with.step(0.01);
      without.step(0.01);
      apart = std::min(apart, nearest_points(with));
      through = std::min(through, nearest_points(without));
    }
    EXPECT_GT(apart, 3.9e-3) << simd;
    EXPECT_LT(through, 2e-3) << simd;
  }
}

// The first frames of the reference run, digit by digit; the whole of it in the long tier.
TEST(Paper, GivesTheReferenceLiftAgain) {
  const ClothRun reference = read_cloth_run(data("lift_400cm3_centre"));
  const ClothRun run = paper_lift(centre_lift(), reference_fabric(), reference_paper_settings(1.2e-6),
                                  full_tier() ? 1 << 30 : 4);
  for (std::size_t i = 0; i <= 4; ++i) {
    EXPECT_NEAR(run[i].volume, reference[i].volume, 2e-12) << i;
    EXPECT_NEAR(run[i].pressure, reference[i].pressure, 2e-3) << i;
    EXPECT_NEAR(run[i].force, reference[i].force, 2e-6) << i;
    EXPECT_NEAR(run[i].max_stretch, reference[i].max_stretch, 2e-6) << i;
    EXPECT_NEAR(run[i].p99_stretch, reference[i].p99_stretch, 2e-6) << i;
    EXPECT_NEAR(run[i].mean_stretch, reference[i].mean_stretch, 2e-6) << i;
    EXPECT_NEAR(run[i].top, reference[i].top, 2e-6) << i;
    EXPECT_NEAR(run[i].bottom, reference[i].bottom, 2e-6) << i;
  }
  if (!full_tier()) return;
  ASSERT_EQ(run.size(), reference.size());
  const ClothErrors errors = compare(run, reference);
  EXPECT_LT(errors.force, 0.03);
  EXPECT_LT(errors.pressure, 3);
  EXPECT_LT(errors.volume, 0.02e-6);
  EXPECT_LT(errors.p99_stretch, 0.2);
}

TEST(Paper, GivesTheReferenceVacuumLiftAgain) {
  const ClothRun reference = read_cloth_run(data("vacuum_lift_2cm"));
  const ClothRun run = paper_lift(vacuum_lift(), reference_fabric(), reference_paper_settings(1.2e-6),
                                  full_tier() ? 1 << 30 : 3);
  for (std::size_t i = 0; i < run.size(); ++i) {
    EXPECT_NEAR(run[i].force, reference[i].force, 1e-3 + 1e-3 * reference[i].force) << i;
    EXPECT_NEAR(run[i].max_stretch, reference[i].max_stretch, 1e-5 + 1e-3 * reference[i].max_stretch) << i;
    EXPECT_NEAR(run[i].volume, reference[i].volume, 1e-9 + 2e-3 * reference[i].volume) << i;
  }
}

TEST(Paper, RefusesWhatIsNoGridAndStepsOutOfRange) {
  const Fabric fabric = reference_fabric();
  ClothPattern pattern = reference_pattern(5);
  pattern.columns = 0;
  EXPECT_THROW(PaperCloth(pattern, fabric, {}), Error);
  pattern = reference_pattern(5);
  pattern.springs[3].rest *= 1.1;
  EXPECT_THROW(PaperCloth(pattern, fabric, {}), Error);
  PaperSettings settings;
  settings.step = 0;
  try {
    PaperCloth(reference_pattern(5), fabric, settings);
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("paper.step = 0"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace softpoint::cloth
