// The scenes of the first paper's figures: what is dragged gets where it is dragged to, and what hangs on it
// follows.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <algorithm>

#include "metrics_recorder.h"
#include "player.h"
#include "scene_reader.h"
#include "softpoint/elastic/character.h"
#include "softpoint/elastic/character_shapes.h"

namespace softpoint::scene {
namespace {

Scene read(const std::string& name) {
  return read_scene(std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / (name + ".json"));
}

// A scene in play, and what it measured.
struct Playing {
  explicit Playing(const std::string& name) : player(read(name)), metrics(player) {}

  void until(double time) {
    while (player.time() < time - 1e-9) {
      player.step();
      metrics.record();
    }
  }
  ArticulationState now(std::size_t body) const { return player.articulation(body)->measure(); }
  nlohmann::json measured(std::size_t character) const {
    return nlohmann::json::parse(metrics.json())["characters"][character];
  }
  void expect_sound() const {
    EXPECT_EQ(player.system().profile().totals.guard_fired, 0);
    for (std::size_t k = 0; k < player.deformable_count(); ++k) {
      for (const Vec3& x : player.deformable(k).points()) ASSERT_TRUE(x.allFinite());
    }
  }

  Player player;
  MetricsRecorder metrics;
};

std::vector<Vec3> points_of(const Deformable& body) { return {body.points().begin(), body.points().end()}; }

TEST(CharacterScenes, SevenCylindersAreStretchedByHalfAndSwingBack) {
  Playing scene("character_stretch");
  EXPECT_EQ(scene.player.articulation(0)->visible_points(), 64 * 7 + 18);
  EXPECT_EQ(scene.player.articulation(0)->visible_faces(), 128 * 7 + 32);
  scene.until(1.6);
  EXPECT_NEAR(scene.now(0).parts[0].length, 2.1, 0.01);
  EXPECT_LT(scene.now(0).gap, 1e-6);
  scene.until(3.5);
  EXPECT_NEAR(scene.now(0).parts[0].length, 1.4, 0.01);
  scene.until(4.7);
  EXPECT_NEAR(scene.now(0).parts[0].length, 1.75, 0.01);
  scene.until(scene.player.scene().frames * scene.player.scene().world.time_step);
  EXPECT_NEAR(scene.now(0).parts[0].length, 1.4, 0.05);
  scene.expect_sound();
}

// The skin itself is dragged: the vertex follows the hand, both ends bear what it pulls, and let go the row
// is where it was.
TEST(CharacterScenes, APinchedVertexTakesTheRowAlong) {
  Playing scene("character_pinch");
  scene.until(0.3);
  const std::vector<Vec3> rest = points_of(scene.player.deformable(0));
  const auto lowest = std::min_element(rest.begin(), rest.end(), [](const Vec3& a, const Vec3& b) {
    return (a - Vec3(0, 0.8, 0)).norm() < (b - Vec3(0, 0.8, 0)).norm();
  });
  const auto pinched = static_cast<std::size_t>(lowest - rest.begin());
  const auto& row = dynamic_cast<const elastic::Character&>(scene.player.deformable(0));
  const Vec3 weight = row.end_force({0, false}) + row.end_force({0, true});
  const auto moved = [&](std::size_t point) { return Vec3(row.points()[point] - rest[point]); };
  scene.until(1.7);
  EXPECT_LT((moved(pinched) - Vec3(0, -0.25, 0)).norm(), 1e-4);
  const std::vector<Vec3> bone = row.assembly().bone(0);
  EXPECT_LT(bone[2].y(), 0.8);  // of 0.9 m at rest: more than a dent
  const Vec3 borne = row.end_force({0, false}) + row.end_force({0, true}) - weight;
  EXPECT_GT(borne.y(), 20.0);
  EXPECT_LT(std::hypot(borne.x(), borne.z()), 0.01 * borne.y());
  scene.until(2.5);
  EXPECT_LT((moved(pinched) - Vec3(0.15, -0.15, 0.1)).norm(), 1e-4);
  scene.until(3.1);
  for (std::size_t p = 0; p < rest.size(); ++p) ASSERT_LT(moved(p).norm(), 1e-3) << p;
  scene.until(4.3);  // a hand of 15 N does not reach half a metre
  const Vec3 tugged = row.end_force({0, false}) + row.end_force({0, true}) - weight;
  EXPECT_NEAR(tugged.z(), -15.0, 0.3);
  EXPECT_GT(row.assembly().bone(0)[2].z(), 0.01);
  EXPECT_LT(row.assembly().bone(0)[2].z(), 0.3);
  scene.until(5.0);
  for (std::size_t p = 0; p < rest.size(); ++p) ASSERT_LT(moved(p).norm(), 1e-3) << p;
  scene.expect_sound();
}

TEST(CharacterScenes, ThirteenCylindersAreBentByHalfATurn) {
  Playing scene("character_bend");
  EXPECT_EQ(scene.player.articulation(0)->visible_points(), 64 * 13 + 18);
  scene.until(2.8);
  EXPECT_NEAR(scene.now(0).parts[0].bend, M_PI, 0.01);
  EXPECT_LT(scene.now(0).kink, 0.25);
  EXPECT_NEAR(scene.now(0).parts[0].length, 13 * 0.16, 0.03);
  EXPECT_NEAR(scene.now(0).volume / scene.measured(0)["volume"]["rest"].get<double>(), 1.0, 0.05);
  scene.expect_sound();
}

TEST(CharacterScenes, ChainsOfTableOneHaveItsCountsAndAreCurledUp) {
  Playing scene("character_chains");
  const int vertices[] = {658, 1938, 3218, 4498, 6418}, triangles[] = {1312, 3872, 6432, 8992, 12832};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(scene.player.articulation(k)->visible_points(), vertices[k]);
    EXPECT_EQ(scene.player.articulation(k)->visible_faces(), triangles[k]);
  }
  scene.until(1.0);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_NEAR(scene.now(k).parts[0].bend, M_PI / 3, 0.02) << k;
  scene.expect_sound();
}

TEST(CharacterScenes, ExoskeletonsOfTableTwoAreLiftedByACorner) {
  Playing scene("character_exoskeletons");
  const std::size_t vertices[] = {26, 56, 98, 218, 386};
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(scene.player.deformable(2 * k).points().size(), vertices[k]);
  }
  scene.until(2.4);
  for (int k = 0; k < 5; ++k) {
    EXPECT_GT(scene.player.center({true, 2 * k}).y(), 0.6) << k;      // lifted
    EXPECT_GT(scene.player.center({true, 2 * k + 1}).y(), 0.5) << k;  // and what hangs in it
  }
  scene.expect_sound();
}

TEST(CharacterScenes, TheCharacterOfNinePartsIsTheOneOfTheFigure) {
  Playing scene("character_nine");
  EXPECT_EQ(scene.player.articulation(1)->visible_points(), 2402);
  EXPECT_EQ(scene.player.articulation(1)->segments(), 35);
  // The builder makes the same one.
  const elastic::Material material{10e3, 0.3, 100};
  const auto shape = elastic::nine_part_character(1.2, 0.09, material);
  const elastic::Character built(shape.design, {}, {0, 1.6, 0});
  const auto a = points_of(built), b = points_of(scene.player.deformable(1));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t p = 0; p < a.size(); ++p) ASSERT_LT((a[p] - b[p]).norm(), 1e-4) << p;
  EXPECT_EQ(shape.exoskeleton.vertex_count(), 26);
  EXPECT_EQ(shape.hangings.size(), 18u);

  scene.until(2.1);  // swung to the left by its head
  EXPECT_LT(scene.player.center({true, 1}).x(), -0.3);
  scene.expect_sound();
}

TEST(CharacterScenes, APulledLegPullsTheTorso) {
  Playing scene("character_eight");
  EXPECT_EQ(scene.player.articulation(1)->visible_points(), 1466);
  const elastic::Material material{20e3, 0.3, 100};
  const auto shape = elastic::eight_part_character(0.9, material);
  const elastic::Character built(shape.design, {}, {0, 1.3, 0});
  const auto a = points_of(built), b = points_of(scene.player.deformable(1));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t p = 0; p < a.size(); ++p) ASSERT_LT((a[p] - b[p]).norm(), 1e-4) << p;

  scene.until(0.6);
  const auto& body = dynamic_cast<const elastic::Character&>(scene.player.deformable(1));
  const Vec3 before = body.assembly().bone(0)[1];  // between belly and chest
  scene.until(2.0);
  const Vec3 moved = body.assembly().bone(0)[1] - before;
  EXPECT_GT(moved.x(), 0.02) << moved.transpose();  // towards the leg that was pulled
  scene.expect_sound();
}

TEST(CharacterScenes, FourBodiesBendWhereOneSwells) {
  Playing scene("character_one_or_four");
  scene.until(2.4);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(scene.now(k).parts[0].bend, 150 * M_PI / 180, 0.02);
  const auto change = [&](std::size_t k) {
    return std::abs(scene.now(k).volume / scene.measured(k)["volume"]["rest"].get<double>() - 1.0);
  };
  EXPECT_LT(change(1), 0.1);
  EXPECT_GT(change(0), 2.0 * change(1));
  scene.expect_sound();
}

TEST(CharacterScenes, TwoCubesShareNineVertices) {
  Playing scene("character_two_cubes");
  EXPECT_EQ(scene.player.articulation(0)->visible_points(), 26 + 26 - 9 - 1);
  EXPECT_EQ(scene.player.deformable(0).points().size(), 43u);
  scene.until(1.1);
  EXPECT_NEAR(scene.now(0).parts[0].length, 1.05, 0.01);
  scene.until(2.3);
  EXPECT_NEAR(scene.now(0).parts[0].bend, M_PI / 3, 0.02);
  scene.until(4.1);
  EXPECT_LT(scene.now(0).parts[0].bend, 0.02);
  EXPECT_LT((scene.player.articulation(0)->turn(1) - Vec3(M_PI / 3, 0, 0)).norm(), 1e-3);
  scene.expect_sound();
}

}  // namespace
}  // namespace softpoint::scene
