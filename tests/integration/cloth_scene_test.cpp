// Cloth in scene files: what is read, what is measured, what the switches do.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "metrics_recorder.h"
#include "player.h"
#include "scene_reader.h"
#include "support/refusal.h"
#include "trace_recorder.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

json wet_sheet() {
  return json::parse(R"({
    "rigid_bodies": [{"name": "floor", "shape": "plane"}],
    "deformables": [
      {"name": "sheet", "plugin": "cloth", "position": [0, 0.0005, 0],
       "pattern": {"kind": "square", "points": [20, 20], "size": [0.2, 0.2],
         "bumps": [{"at": [0, 0, 0], "radius": 0.07, "height": 0.02}]},
       "fabric": {"weave": "satin", "fiber": "polyester"},
       "wetness": {"saturation": 1}, "air": {"leak": false}}],
    "frames": 60})");
}

Scene read_cloth_scene(const json& document) {
  Scene scene;
  const DeformablePlugins plugins = deformable_plugins();
  read_json_text(document.dump(), "scene.json", "",
                 [&](ObjectReader& root) { read_scene(root, plugins, scene); });
  return scene;
}

json played_cloth(const json& document) {
  Player player(read_cloth_scene(document));
  MetricsRecorder metrics(player);
  while (player.frame() < player.scene().frames) {
    player.step();
    metrics.record();
  }
  EXPECT_EQ(player.system().profile().totals.guard_fired, 0);
  return json::parse(metrics.json()).at("cloths").at(0);
}

TEST(ClothScene, WetSheetKeepsItsBubble) {
  const json cloth = played_cloth(wet_sheet());
  EXPECT_EQ(cloth["name"], "sheet");
  EXPECT_EQ(cloth["points"], 400);
  EXPECT_GT(cloth["area"].get<double>(), 0.04);  // the bump is slack
  EXPECT_EQ(cloth["bubbles"]["end"], 1);
  const double bump = 3.14159 * 0.07 * 0.07 * 0.02 / 3;
  EXPECT_NEAR(cloth["volume"]["end"].get<double>(), bump, 0.15 * bump);
  EXPECT_GT(cloth["gauge"]["end"].get<double>(), 0) << "its weight";
  EXPECT_LT(cloth["gauge"]["end"].get<double>(), 100);
  EXPECT_LT(cloth["air_audit_largest"].get<double>(), 1e-9 * 101325 * bump);
  EXPECT_EQ(cloth["frames_without_air"], 0);
  EXPECT_LT(cloth["stretch_99"]["end"].get<double>(), 0.02);
  EXPECT_GT(cloth["highest"]["end"].get<double>(), 0.01);
  EXPECT_GT(cloth["contact_area"]["end"].get<double>(), 0.01);
}

TEST(ClothScene, DrySheetPaysNothingForAirAndCollapses) {
  json document = wet_sheet();
  document["deformables"][0].erase("wetness");
  document["frames"] = 120;
  const json cloth = played_cloth(document);
  EXPECT_EQ(cloth["frames_without_air"], 120);
  EXPECT_EQ(cloth["bubbles"]["largest"], 0);
  EXPECT_LT(cloth["highest"]["end"].get<double>(), 0.018);
}

// While the rim comes to touch there are several for a frame; how it lets go: cloth_events_test.
TEST(ClothScene, TheSwitchOfTheAirLetsItGo) {
  json document = wet_sheet();
  document["events"] = json::parse(R"([
    {"at": 0.5, "do": "toggle", "what": "plugin", "body": "sheet", "switch": "air", "on": false}])");
  const json cloth = played_cloth(document);
  EXPECT_EQ(cloth["frames_without_air"], 30);
  EXPECT_GE(cloth["bubbles"]["largest"], 1);
  EXPECT_EQ(cloth["bubbles"]["end"], 0);
}

TEST(ClothScene, PaintedWaterIsWhereItWasPainted) {
  json document = wet_sheet();
  document["deformables"][0]["wetness"] = json::parse(R"({"saturation": 0.2, "capacity": 0.5, "paint": [
        {"at": [0.1, 0, 0.1], "radius": 0.06, "saturation": 0.9},
        {"at": [0.1, 0, 0.1], "radius": 0.02, "saturation": 0}]})");
  const Player player(read_cloth_scene(document));
  const auto saturation = player.sheet(0)->saturation();
  const auto points = player.deformable(0).points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double distance = (points[i] - Vec3(0.1, 0.0005, 0.1)).norm();
    EXPECT_EQ(saturation[i], distance < 0.02 ? 0.0 : distance < 0.06 ? 0.9 : 0.2) << points[i].transpose();
  }
}

TEST(ClothScene, ItsSheetFacesUpWithTheWarpAlongX) {
  json document = wet_sheet();
  document["deformables"][0]["pattern"] = {{"kind", "square"}, {"points", {5, 9}}, {"size", {0.2, 0.4}}};
  const Player player(read_cloth_scene(document));
  Vec3 low = player.deformable(0).points().front(), high = low, normal = Vec3::Zero();
  for (const Vec3& x : player.deformable(0).points()) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const auto points = player.deformable(0).points();
  for (const auto& [a, b, c] : player.deformable(0).faces()) {
    normal.y() += (points[b] - points[a]).z() * (points[c] - points[a]).x() -
                  (points[b] - points[a]).x() * (points[c] - points[a]).z();
  }
  EXPECT_NEAR((high - low).x(), 0.2, 1e-12);
  EXPECT_NEAR((high - low).y(), 0, 1e-12);
  EXPECT_NEAR((high - low).z(), 0.4, 1e-12);
  EXPECT_NEAR(normal.y() / 2, 0.08, 1e-12);
}

TEST(ClothScene, TracesAirAndStretch) {
  Player player(read_cloth_scene(wet_sheet()));
  TraceRecorder trace(player);
  player.step();
  trace.record();
  const std::string csv = trace.csv(), head = csv.substr(0, csv.find('\n'));
  for (const char* column :
       {"sheet.bubbles", "sheet.volume", "sheet.gauge", "sheet.stretch_99", "sheet.highest"}) {
    EXPECT_NE(head.find(column), std::string::npos) << column;
  }
  std::string row = csv.substr(csv.find('\n') + 1);
  row = row.substr(0, row.find('\n'));
  EXPECT_EQ(std::count(head.begin(), head.end(), ','), std::count(row.begin(), row.end(), ','));
}

TEST(ClothScene, RefusesWhatIsNoCloth) {
  const auto refused = [](const char* pointer, const json& value, std::vector<std::string> fragments) {
    json document = wet_sheet();
    document[json::json_pointer(std::string("/deformables/0/") + pointer)] = value;
    fragments.push_back("scene.json: /deformables/0");
    expect_refusal([&] { read_cloth_scene(document); }, fragments);
  };
  refused("fabric/weave", "velvet", {"weave", "velvet", "plain, twill, satin"});
  refused("fabric/fiber", "polyestr", {"fiber", "polyester"});
  refused("pattern/points", {2.5, 3}, {"points", "whole"});
  refused("pattern/points", {1, 3}, {"points/0", "1", "2"});
  refused("pattern/kind", "round", {"kind", "round", "square, sphere, obj"});
  refused("air/release_gap", 1e-4, {"release_gap", "touch_gap"});
  refused("air/bubbles", "many", {"bubbles", "many", "found, one, off"});
  refused("wetness/saturation", 1.5, {"saturation", "1.5"});
  refused("wetness/moisture", 1, {"moisture"});
  json ball = wet_sheet();
  ball["deformables"][0]["pattern"] = {{"kind", "sphere"}, {"radius", 0.1}};
  expect_refusal([&] { read_cloth_scene(ball); }, {"pattern", "weft"});  // satin is weaker along the weft
}

}  // namespace
}  // namespace softpoint::scene
