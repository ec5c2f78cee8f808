// Event lists for all that can be dragged or toggled of a cloth, each with what has to come of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "player.h"
#include "scene_reader.h"
#include "sheet.h"
#include "softpoint/cloth/cloth.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

// A sheet of 20 x 20 points, 0.2 m wide, over a floor.
json sheet_over_floor(double height, bool wet) {
  json document = json::parse(R"({
    "rigid_bodies": [{"name": "floor", "shape": "plane"}],
    "deformables": [{"name": "sheet", "plugin": "cloth",
       "pattern": {"kind": "square", "points": [20, 20], "size": [0.2, 0.2]},
       "fabric": {"weave": "satin", "fiber": "polyester"}}],
    "frames": 600})");
  document["deformables"][0]["position"] = {0, height, 0};
  if (wet) document["deformables"][0]["wetness"] = {{"saturation", 1}};
  return document;
}

// A scene with events in play.
struct EventPlay {
  EventPlay(json document, const char* events) : player(scene_of(std::move(document), events)) {}

  static Scene scene_of(json document, const char* events) {
    document["events"] = json::parse(events);
    Scene scene;
    const DeformablePlugins plugins = deformable_plugins();
    read_json_text(document.dump(), "scene.json", "",
                   [&](ObjectReader& root) { read_scene(root, plugins, scene); });
    return scene;
  }
  void until(double time) {
    while (player.time() < time - 1e-9) player.step();
    EXPECT_EQ(player.system().profile().totals.guard_fired, 0);
  }
  const cloth::Cloth& sheet() const { return dynamic_cast<const cloth::Cloth&>(player.deformable(0)); }
  Vec3 point(int i, int j) const {
    return player.deformable(0).points()[static_cast<std::size_t>(j * 20 + i)];
  }
  double top() const {
    double height = -1;
    for (const Vec3& x : player.deformable(0).points()) height = std::max(height, x.y());
    return height;
  }
  double bottom() const {
    double height = 1e9;
    for (const Vec3& x : player.deformable(0).points()) height = std::min(height, x.y());
    return height;
  }
  SheetState now() const { return player.sheet(0)->measure(); }

  Player player;
};

TEST(ClothEvents, APickedPointFollowsTheHandAndFallsWhenReleased) {
  EventPlay play(sheet_over_floor(0.001, false), R"([
    {"at": 0.1, "do": "grab", "handle": "hand", "body": "sheet", "vertex": 210},
    {"at": 0.1, "do": "move", "handle": "hand", "from": "handle", "to": [0.02, 0.06, -0.03], "duration": 0.5},
    {"at": 0.8, "do": "release", "handle": "hand"}])");
  play.until(0.1);
  const Vec3 start = play.point(10, 10);
  play.until(0.75);
  EXPECT_LT((play.point(10, 10) - start - Vec3(0.02, 0.06, -0.03)).norm(), 1e-5);
  play.until(2);
  EXPECT_LT(play.top(), 0.03);
  EXPECT_GT((play.point(10, 10) - start).norm(), 0.01);  // it fell where it was let go
}

TEST(ClothEvents, ALimitedHandDoesNotTearWetClothOffTheFloor) {
  const auto lifted = [](const char* events) {
    EventPlay play(sheet_over_floor(0.0005, true), events);
    play.until(1.2);
    return play.point(10, 10).y();
  };
  EXPECT_LT(lifted(R"([
    {"at": 0.5, "do": "grab", "handle": "hand", "body": "sheet", "vertex": 210, "max_force": 0.05},
    {"at": 0.5, "do": "move", "handle": "hand", "from": "handle", "to": [0, 0.05, 0], "duration": 0.5}])"),
            0.01);
  EXPECT_GT(lifted(R"([
    {"at": 0.5, "do": "grab", "handle": "hand", "body": "sheet", "vertex": 210},
    {"at": 0.5, "do": "move", "handle": "hand", "from": "handle", "to": [0, 0.05, 0], "duration": 0.5}])"),
            0.045);
}

TEST(ClothEvents, ManyPinnedPointsHoldAndAreReleasedTogether) {
  EventPlay play(sheet_over_floor(0.5, false), R"([
    {"at": 0, "do": "pin", "handle": "corner", "body": "sheet", "near": [-0.1, 0.5, -0.1], "radius": 0.025},
    {"at": 0, "do": "pin", "handle": "others", "body": "sheet", "vertices": [17, 18, 19]},
    {"at": 1, "do": "release", "handle": "corner"},
    {"at": 2, "do": "release", "handle": "others"}])");
  play.until(0.02);
  const std::vector<Vec3> start(play.player.deformable(0).points().begin(),
                                play.player.deformable(0).points().end());
  const auto held = [&] {
    int count = 0;
    for (std::size_t p = 0; p < start.size(); ++p)
      count += (play.player.deformable(0).points()[p] - start[p]).norm() < 1e-4;
    return count;
  };
  play.until(0.95);
  const int at_first = held();
  EXPECT_GE(at_first, 3 + 6);  // the corner, and what is within two and a half cells of it
  EXPECT_LT(play.bottom(), 0.4);
  EXPECT_GT(play.bottom(), 0.2);
  play.until(1.95);
  EXPECT_GE(held(), 3);
  EXPECT_LE(held(), at_first - 5);
  play.until(3.5);
  EXPECT_LT(play.top(), 0.1);  // on the floor
}

TEST(ClothEvents, ABoxTiedToTheClothHangsOnItUntilReleased) {
  json document = sheet_over_floor(0.5, false);
  document["rigid_bodies"].push_back(json::parse(R"({"name": "box", "shape": "box",
    "size": [0.04, 0.04, 0.04], "mass": 0.05, "position": [0, 0.52, 0.11]})"));
  EventPlay play(document, R"([
    {"at": 0, "do": "pin", "handle": "top", "body": "sheet", "near": [0, 0.5, -0.1], "radius": 0.05},
    {"at": 0, "do": "attach", "handle": "tie", "body": "sheet", "to": "box", "near": [0, 0.5, 0.1], "radius": 0.006},
    {"at": 3, "do": "release", "handle": "tie"}])");
  const auto box = [&] { return double(play.player.rigid(1).body().getWorldTransform().getOrigin().y()); };
  play.until(2.9);
  const double hung = box();
  EXPECT_GT(hung, 0.2);
  EXPECT_LT(hung, 0.4);
  play.until(4.5);
  EXPECT_LT(box(), 0.05);
}

TEST(ClothEvents, TheSwitchOfTheAirLetsGoAndHoldsAgain) {
  json document = sheet_over_floor(0.0005, true);
  document["deformables"][0]["pattern"]["bumps"] =
      json::parse(R"([{"at": [0, 0, 0], "radius": 0.07, "height": 0.02}])");
  document["deformables"][0]["air"] = {{"leak", false}};
  EventPlay play(document, R"([
    {"at": 0.5, "do": "toggle", "what": "plugin", "body": "sheet", "switch": "air", "on": false},
    {"at": 1.2, "do": "toggle", "what": "plugin", "body": "sheet", "switch": "air"},
    {"at": 1.4, "do": "grab", "handle": "hand", "body": "sheet", "vertex": 210, "max_force": 3},
    {"at": 1.4, "do": "move", "handle": "hand", "from": "handle", "to": [0, 0.06, 0], "duration": 0.3}])");
  play.until(0.2);
  for (int i = 0; i < 18; ++i) {
    play.player.step();
    EXPECT_EQ(play.now().bubbles, 1);
  }
  const double held = play.top();
  EXPECT_GT(held, 0.01);
  play.until(0.52);
  EXPECT_EQ(play.now().bubbles, 0);
  play.until(1.19);
  EXPECT_EQ(play.now().bubbles, 0);
  EXPECT_LT(play.top(), 0.9 * held);  // nothing carries the bump any longer
  double least = 0;
  while (play.player.time() < 2) {
    play.player.step();
    least = std::min(least, play.now().gauge);
  }
  EXPECT_LT(least, -20);
}

TEST(ClothEvents, TheSwitchOfItsWeight) {
  EventPlay play(sheet_over_floor(0.4, false), R"([
    {"at": 0, "do": "toggle", "what": "plugin", "body": "sheet", "switch": "gravity", "on": false},
    {"at": 0.5, "do": "toggle", "what": "plugin", "body": "sheet", "switch": "gravity"}])");
  play.until(0.5);
  EXPECT_NEAR(play.bottom(), 0.4, 1e-6);
  play.until(2.5);
  EXPECT_LT(play.top(), 0.02);
}

TEST(ClothEvents, TheSwitchOfTheWorldsWeight) {
  EventPlay play(sheet_over_floor(0.4, false), R"([
    {"at": 0, "do": "toggle", "what": "gravity", "on": false},
    {"at": 0.5, "do": "toggle", "what": "gravity"}])");
  play.until(0.5);
  EXPECT_NEAR(play.bottom(), 0.4, 1e-6);
  play.until(2.5);
  EXPECT_LT(play.top(), 0.02);
}

// Stood on its edge it folds up on itself.
TEST(ClothEvents, TheSwitchOfSelfContact) {
  const auto worst = [](bool on) {
    json document = sheet_over_floor(0.12, false);
    document["deformables"][0]["orientation"] = json::parse(R"({"axis": [1, 0, 0.1], "angle": "88 deg"})");
    document["deformables"][0]["self_contact"] = {{"on", !on}};
    EventPlay play(document, on ? R"([{"at": 0, "do": "toggle", "what": "plugin", "body": "sheet",
                                      "switch": "self_contact", "on": true}])"
                                : R"([{"at": 0, "do": "toggle", "what": "plugin", "body": "sheet",
                                      "switch": "self_contact", "on": false}])");
    int most = 0;
    for (int i = 1; i <= 8; ++i) {
      play.until(0.15 * i);
      most = std::max(most, play.sheet().count_intersections());
    }
    return most;
  };
  EXPECT_EQ(worst(true), 0);
  EXPECT_GT(worst(false), 0);
}

TEST(ClothEvents, TakenOutOfTheWorldItStaysAsItIs) {
  EventPlay play(sheet_over_floor(0.4, false), R"([
    {"at": 0.1, "do": "toggle", "what": "body", "body": "sheet", "on": false},
    {"at": 0.5, "do": "toggle", "what": "body", "body": "sheet"}])");
  play.until(0.12);
  const double out = play.bottom();
  play.until(0.48);
  EXPECT_EQ(play.bottom(), out);
  play.until(2.5);
  EXPECT_LT(play.top(), 0.02);
}

}  // namespace
}  // namespace softpoint::scene
