// Against the reference runs of explicit steps of 1.2 us.
#include <gtest/gtest.h>

#include <cmath>

#include "lift_scene.h"

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

}  // namespace
