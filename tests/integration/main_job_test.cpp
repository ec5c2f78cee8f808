#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "metrics_recorder.h"
#include "player.h"
#include "scene_reader.h"

namespace softpoint::scene {
namespace {

// The project's first scene in full, at 1/60 s a step: nothing enters anything.
TEST(MainJob, NoVertexIsDeeperThanAMillimetreAndNoCornerDeeperThanTwo) {
  const auto file = std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / "main_elastic.json";
  Player player(read_scene(file));
  ASSERT_DOUBLE_EQ(player.scene().world.substep(), 1.0 / 60.0);
  MetricsRecorder metrics(player);
  bool grabbed[2] = {false, false};
  double speed_when_released = 0;
  while (player.frame() < player.scene().frames) {
    player.step();
    metrics.record();
    for (std::size_t h = 0; h < 2; ++h) {
      const bool now = !player.handles().held(h).empty();
      if (grabbed[h] && !now) {
        const Deformable& body = player.deformable(1 - h);
        speed_when_released = std::max(speed_when_released, body.momentum().norm() / body.total_mass());
      }
      grabbed[h] = now;
    }
  }
  const Depth& vertex = metrics.penetration().vertex;
  const Depth& corner = metrics.penetration().corner;
  EXPECT_LE(vertex.depth, 1e-3) << "frame " << vertex.frame << ", vertex " << vertex.point << " of "
                                << vertex.deformable << " in " << vertex.rigid;
  EXPECT_LE(corner.depth, 2e-3) << "frame " << corner.frame << ", corner " << corner.point << " of "
                                << corner.rigid << " in " << corner.deformable;
  EXPECT_EQ(player.system().profile().totals.guard_fired, 0);
  EXPECT_EQ(player.system().profile().totals.late_substeps, 0);
  EXPECT_GT(speed_when_released, 0.3);  // they were swung

  const auto report = nlohmann::json::parse(metrics.json());
  EXPECT_EQ(report["frames"].get<int>(), player.scene().frames);
  EXPECT_GT(report["step_seconds"]["p50"].get<double>(), 0.0);
  EXPECT_LE(report["step_seconds"]["p10"].get<double>(), report["step_seconds"]["max"].get<double>());
  EXPECT_GT(report["counts"]["contacts"]["total"].get<int>(), 0);
  // What falls and is dragged can only have the energy it began with, and what the hands gave.
  EXPECT_LT(report["energy"]["end"]["kinetic"].get<double>(), 50.0);
}

}  // namespace
}  // namespace softpoint::scene
