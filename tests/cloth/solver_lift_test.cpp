// Against the reference runs of explicit steps of 1.2 us.
#include <gtest/gtest.h>

#include <cmath>

#include "lift_scene.h"
#include "support/solver_sheet.h"

namespace {

using namespace softpoint;
using namespace softpoint::cloth;
using softpoint::cloth::lift::Lift;
using softpoint::cloth::lift::Row;

// K = 0: a whole atmosphere holds the cloth down; friction decides how far it is drawn in.
TEST(ClothLift, VacuumFollowsTheReference) {
  const std::vector<Row> reference = lift::read_rows("vacuum_lift_2cm.csv");
  for (Precision precision : {Precision::kSingle, Precision::kDouble}) {
    ClothSettings settings;
    settings.precision = precision;
    Lift scene(settings, 0, 0.02, 0.5);
    for (std::size_t f = 1; f < reference.size(); ++f) {
      const Row row = scene.step();
      EXPECT_NEAR(row.force, reference[f].force, 0.01 * reference[f].force) << "frame " << f;
      EXPECT_NEAR(row.largest, reference[f].largest, 0.005) << "frame " << f;
      EXPECT_NEAR(row.volume, reference[f].volume, 0.02) << "frame " << f;
      EXPECT_LT(std::abs(row.pressure), 1e-9) << "frame " << f;
      EXPECT_GE(row.bottom, -1e-7) << "frame " << f;
    }
  }
}

// Four times as many points, each a quarter as heavy on springs as stiff: all by explicit steps, none
// refused. The forms of smoothing that came before burst here.
TEST(ClothLift, FineSheetIsStableByExplicitSteps) {
  ClothRun run;
  SolverProfile profile;
  run = solver_lift(
      centre_lift(100), settings_of(Dial::kDefault),
      [&](SolverSheet& sheet, int) { profile = sheet.solver.profile(); }, 36);
  ASSERT_EQ(run.size(), 37u);
  EXPECT_EQ(profile.march_refused, 0);
  EXPECT_EQ(profile.marched, 36 * 240);
  for (const ClothFrame& frame : run) {
    EXPECT_LT(frame.max_stretch, 0.015) << frame.time;
    EXPECT_NEAR(frame.volume, 400e-6, 0.5e-6) << frame.time;
  }
}

// Hardly any shear stiffness, as woven cloth has: what explicit steps cannot take (in a half of the frames)
// is refused and swept, and nothing bursts.
TEST(ClothLift, ClothWithoutShearStiffnessDoesNotBurst) {
  Fabric fabric = reference_fabric();
  fabric.shear_stiffness = 50;
  SolverSheet sheet(reference_pattern(50, fabric), fabric, settings_of(Dial::kDefault));
  const LiftTask task = centre_lift();
  std::vector<Vec3> start = sheet.positions;
  for (Vec3& x : start) x.z() = task.start_height();
  sheet.place(start);
  sheet.floor_friction = LiftTask::kFriction;
  sheet.seal(task.air);
  for (int k = 1; k <= 60; ++k) {
    const double time = k * LiftTask::kFrame;
    const Vec3 at = start[static_cast<std::size_t>(task.picked[0])] + Vec3(0, 0, task.lifted(time));
    sheet.hands = {{task.picked[0], at, Vec3(0, 0, task.speed(time)), INFINITY}};
    sheet.step(LiftTask::kFrame);
    const ClothFrame frame = measure_cloth(sheet.solver.pattern(), sheet.positions);
    EXPECT_LT(frame.max_stretch, 0.03) << k;
    EXPECT_NEAR(sheet.volume(), task.air, 0.5e-6) << k;
  }
  EXPECT_GT(sheet.solver.profile().marched, 60 * 60);
}

}  // namespace
