#include <gtest/gtest.h>

#include "support/precision.h"
#include "support/solver_sheet.h"
#include "support/tier.h"

// The solver beside the fine-step runs of tests/cloth/data.
namespace softpoint::cloth {
namespace {

ClothErrors errors_of(const LiftTask& task, Dial dial) {
  const ClothRun reference = read_cloth_run(std::string(SOFTPOINT_CLOTH_DATA "/") + task.name + ".csv");
  const ClothRun run = solver_lift(task, settings_of(dial));
  EXPECT_EQ(run.size(), reference.size());
  const ClothErrors errors = compare(run, reference);
  std::printf("%s: force %.4f N, pressure %.2f Pa, volume %.4f cm3, p99 of stretch %.3f, largest %.4f\n",
              task.name.c_str(), errors.force, errors.pressure, 1e6 * errors.volume, errors.p99_stretch,
              errors.max_stretch);
  return errors;
}

// Force 0.010 to 0.013 N by instruction set, 99th percentile of stretch off by 8 to 10 %; from starts shaken
// by 1 um to 0.017 N and 15 %.
TEST(ReferenceLift, CentreByTheDefaultDial) {
  const ClothErrors errors = errors_of(centre_lift(), Dial::kDefault);
  EXPECT_LT(errors.force, 0.1);
  EXPECT_LT(errors.pressure, 50);
  EXPECT_LT(errors.volume, 0.5e-6);
  EXPECT_LT(errors.p99_stretch, 0.2);
  EXPECT_LT(errors.max_stretch, 0.015);
}

// Force 0.03 N.
TEST(ReferenceLift, TwoPointsByTheDefaultDial) {
  const ClothErrors errors = errors_of(two_point_lift(), Dial::kDefault);
  EXPECT_LT(errors.force, 0.1);
  EXPECT_LT(errors.pressure, 50);
  EXPECT_LT(errors.volume, 0.5e-6);
  EXPECT_LT(errors.max_stretch, 0.015);
}

// Fine-step runs from starts shaken by 1 um lie 13 to 33 % from each other: means of runs are compared, of
// four here and of six there. 0.22 to 0.23 by instruction set; single runs 0.12 to 0.30.
TEST(ReferenceLift, DISABLED_TailOfTheStretchAtTwoPoints) {
  ClothRun reference;
  std::ifstream file(SOFTPOINT_CLOTH_DATA "/lift_400cm3_two_points_p99.csv");
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    double frame = 0;
    reference.emplace_back();
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &frame, &reference.back().time,
                          &reference.back().p99_stretch),
              3);
  }
  ClothRun mean(reference.size());
  constexpr int kStarts = 4;
  for (int start = 0; start < kStarts; ++start) {
    const ClothRun run =
        solver_lift(two_point_lift(), settings_of(Dial::kDefault), {}, 1 << 30, start == 0 ? 0 : 1e-6, start);
    ASSERT_EQ(run.size(), reference.size());
    for (std::size_t i = 0; i < run.size(); ++i) mean[i].p99_stretch += run[i].p99_stretch / kStarts;
  }
  const double off = compare(mean, reference).p99_stretch;
  std::printf("two points, mean of %d starts: p99 of stretch %.3f\n", kStarts, off);
  EXPECT_LT(off, 0.2);
}

// Fine-step runs from starts shaken by 1 um differ by 0.006 to 0.049 N and by 3 to 32 % in the 99th
// percentile of stretch; at two points by 0.014 to 0.042 N and 9 to 24 %. These starts are not shaken, as the
// references' are not: 0.022 N and 10 %; 0.024 N and 7 %. Shaken by 1 um: 0.017 to 0.023 N and 7 to 22 %;
// 0.03 to 0.15 N and 8 to 56 %.
void expect_exact(const LiftTask& task) {
  const ClothErrors errors = errors_of(task, Dial::kExact);
  EXPECT_LT(errors.force, 0.03);
  EXPECT_LT(errors.pressure, 50);
  EXPECT_LT(errors.volume, 0.5e-6);
  EXPECT_LT(errors.p99_stretch, 0.2);
  EXPECT_LT(errors.max_stretch, 0.015);
}

TEST(ReferenceLift, CentreByTheExactDial) {
  if (!full_tier()) GTEST_SKIP() << "with SOFTPOINT_TEST_FULL=1 only";
  expect_exact(centre_lift());
}

TEST(ReferenceLift, TwoPointsByTheExactDial) {
  if (!full_tier()) GTEST_SKIP() << "with SOFTPOINT_TEST_FULL=1 only";
  expect_exact(two_point_lift());
}

// Hung by two corners, dry, without drag: the centre of mass over the first half second.
TEST(ReferenceSwing, FallsAsTheFineStepsDo) {
  std::ifstream file(SOFTPOINT_CLOTH_DATA "/hung_by_two_corners.csv");
  std::string line;
  std::getline(file, line);
  std::vector<double> drops;
  while (std::getline(file, line)) {
    double frame = 0, time = 0, drop = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &frame, &time, &drop), 3);
    drops.push_back(drop);
  }
  ASSERT_GT(drops.size(), 30u);
  Fabric fabric = reference_fabric();
  fabric.drag_rate = 0;
  SolverSheet sheet(reference_pattern(50, fabric), fabric, settings_of(Dial::kDefault));
  for (int p : {0, 49})
    sheet.hands.push_back({p, sheet.positions[static_cast<std::size_t>(p)], Vec3::Zero(), INFINITY});
  double worst = 0;
  for (std::size_t k = 1; k <= 30; ++k) {
    sheet.step(1.0 / 60);
    double drop = 0;
    for (const Vec3& x : sheet.positions) drop -= x.z() / static_cast<double>(sheet.positions.size());
    worst = std::max(worst, std::abs(drop - drops[k]));
  }
  const double deepest = *std::max_element(drops.begin(), drops.begin() + 31);
  std::printf("swing: farthest %.4f of the drop\n", worst / deepest);
  EXPECT_LT(worst, 0.05 * deepest);
}

}  // namespace
}  // namespace softpoint::cloth
