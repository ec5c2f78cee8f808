#include "player.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "metrics_state.h"
#include "scene_reader.h"
#include "sibling.h"
#include "support/refusal.h"
#include "trace_recorder.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

Scene read(const json& document) {
  Scene scene;
  const DeformablePlugins plugins = deformable_plugins();
  read_json_text(document.dump(), "scene.json", "",
                 [&](ObjectReader& root) { read_scene(root, plugins, scene); });
  return scene;
}

json cube_and_box(const std::string& kind = "discrete") {
  json document = json::parse(R"({
    "rigid_bodies": [
      {"name": "floor", "shape": "plane"},
      {"name": "box", "shape": "box", "size": [0.2, 0.2, 0.2], "mass": 1, "position": [1, 0.5, 0]}],
    "deformables": [
      {"name": "cube", "plugin": "elastic", "mesh": {"kind": "box", "size": [0.2, 0.2, 0.2], "cells": [2, 2, 2]},
       "material": {"young": 1e5}, "position": [0, 0.5, 0]}],
    "frames": 30
  })");
  document["world"]["kind"] = kind;
  return document;
}

std::string trace_of(const json& document, int frames) {
  Player player(read(document));
  TraceRecorder trace(player);
  for (int k = 0; k < frames; ++k) {
    player.step();
    trace.record();
  }
  return trace.csv();
}

class EveryWorld : public ::testing::TestWithParam<const char*> {};

TEST(Player, DropsABodyOntoAMesh) {
  Player player(read_scene(std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes" / "terrain.json"));
  for (int k = 0; k < 90; ++k) {
    player.step();
  }
  for (int d = 0; d < 3; ++d) {
    EXPECT_GT(player.center({true, d}).y(), 0.0) << d;  // the ground is nowhere below -0.04 m
    EXPECT_LT(player.center({true, d}).y(), 0.6) << d;
  }
  EXPECT_EQ(player.system().profile().counts.pairs_skipped, 0);
  EXPECT_GT(player.system().profile().counts.contacts, 0);
}

TEST_P(EveryWorld, DropsBothKindsOfBodyOntoTheFloor) {
  Player player(read(cube_and_box(GetParam())));
  for (int k = 0; k < 120; ++k) {
    player.step();
  }
  EXPECT_NEAR(player.center({true, 0}).y(), 0.1, 0.01);
  EXPECT_NEAR(player.center({false, 1}).y(), 0.1, 0.01);
  EXPECT_EQ(player.system().profile().totals.late_substeps, 0);
  EXPECT_EQ(player.system().profile().totals.refactorizations, 0);
}

INSTANTIATE_TEST_SUITE_P(Stock, EveryWorld,
                         ::testing::Values("discrete", "multibody", "softrigid", "softmultibody",
                                           "deformable"));

TEST(Player, FallsFreelyAtAnyNumberOfSubsteps) {
  for (const int substeps : {1, 4}) {
    json document = cube_and_box();
    document["rigid_bodies"].erase(0);
    document["world"]["substeps"] = substeps;
    Player player(read(document));
    for (int k = 0; k < 12; ++k) {
      player.step();
    }
    const double t = player.time(), h = t / 12 / substeps;
    const double fall = 0.5 * 9.81 * t * (t + h);  // of semi-implicit Euler
    EXPECT_NEAR(player.center({true, 0}).y(), 0.5 - fall, 1e-6);
    EXPECT_NEAR(player.center({false, 0}).y(), 0.5 - fall, 1e-5);
  }
}

TEST(Player, IsTheSameEveryTime) {
  json document = cube_and_box();
  document["deformables"][0]["velocity"] = {2, 0, 0};
  EXPECT_EQ(trace_of(document, 60), trace_of(document, 60));
}

TEST(Player, AHandleHoldsLeadsAndLetsGo) {
  json document = cube_and_box();
  document["events"] = json::parse(R"([
    {"at": 0, "do": "grab", "handle": "hand", "body": "cube", "near": [0, 1, 0], "near_in": "body"},
    {"at": 0.5, "do": "move", "handle": "hand", "from": "handle", "to": [0.3, 0.4, 0], "duration": 0.5},
    {"at": 2, "do": "release", "handle": "hand"}])");
  Player player(read(document));
  player.step();
  const HandleSet::Held held = player.handles().held(0).at(0);
  const auto vertex = [&] { return player.deformable(0).points()[static_cast<std::size_t>(held.point)]; };
  const Vec3 start = player.handles().position(0);
  EXPECT_NEAR(start.y(), 0.6, 1e-12);
  while (player.time() < 1.9) {
    player.step();
    EXPECT_LT((vertex() - player.handles().position(0)).norm(), 1e-6);
  }
  EXPECT_LT((player.handles().position(0) - start - Vec3(0.3, 0.4, 0)).norm(), 1e-12);
  const double weight = player.deformable(0).total_mass() * 9.81;
  EXPECT_NEAR(player.handles().force(0).y(), weight, 0.5 * weight);
  while (player.time() < 3.0) {
    player.step();
  }
  EXPECT_TRUE(player.handles().held(0).empty());
  EXPECT_LT(player.center({true, 0}).y(), 0.2);
}

TEST(Player, APinKeepsItsVerticesApart) {
  json document = cube_and_box();
  document["events"] = json::parse(R"([{"at": 0, "do": "pin", "handle": "wall", "body": "cube",
    "near": [0, 0.65, 0], "radius": "16 cm"}])");
  Player player(read(document));
  const std::vector<Vec3> before(player.deformable(0).points().begin(), player.deformable(0).points().end());
  for (int k = 0; k < 60; ++k) {
    player.step();
  }
  EXPECT_EQ(player.handles().held(0).size(), 9u);  // the top of the cube
  for (const auto& held : player.handles().held(0)) {
    const auto v = static_cast<std::size_t>(held.point);
    EXPECT_LT((player.deformable(0).points()[v] - before[v]).norm(), 1e-6);
  }
}

TEST(Player, AttachedVerticesStayWhereTheyAreOnTheirBody) {
  json document = cube_and_box();
  document["world"]["gravity"] = {0, 0, 0};
  document["rigid_bodies"][1].update(
      json::parse(R"({"position": [0.25, 0.5, 0], "velocity": [0, 1, 0], "angular_velocity": [1, 2, 3]})"));
  document["events"] = json::parse(R"([{"at": 0, "do": "attach", "handle": "tie", "body": "cube", "to": "box",
    "near": [0.1, 0.5, 0], "radius": "12 cm"},
    {"at": 1, "do": "toggle", "what": "body", "body": "box", "on": false}])");
  Player player(read(document));
  player.step();
  ASSERT_EQ(player.handles().held(0).size(), 5u);
  for (int k = 0; k < 58; ++k) {
    player.step();
    for (const auto& held : player.handles().held(0)) {
      const Vec3& point = player.deformable(0).points()[static_cast<std::size_t>(held.point)];
      ASSERT_LT((point - player.handles().target(0, held)).norm(), 2e-6) << "frame " << k;
    }
  }
  for (int k = 0; k < 5; ++k) {
    player.step();
  }
  EXPECT_TRUE(player.handles().held(0).empty());
  EXPECT_EQ(player.handles().force(0).norm(), 0.0);
}

TEST(Player, AttachedHandlesAreNotLed) {
  json document = cube_and_box();
  document["events"] = json::parse(R"([
    {"at": 0, "do": "attach", "handle": "tie", "body": "cube", "to": "box", "vertices": [1]},
    {"at": 0, "do": "move", "handle": "tie", "to": [0, 1, 0], "duration": 1}])");
  expect_refusal([&] { read(document); }, {"/events/1", "tie", "attached to a body"});
  document["events"][0]["to"] = "cube";
  expect_refusal([&] { read(document); }, {"/events/0/to", "rigid body"});
}

TEST(Player, AnImpulseIsTheChangeOfMomentum) {
  for (const char* body : {"cube", "box"}) {
    for (const bool near : {false, true}) {
      json document = cube_and_box();
      document["world"]["gravity"] = {0, 0, 0};
      json event = {{"at", 0}, {"do", "impulse"}, {"body", body}, {"impulse", {0, 0.5, -0.25}}};
      if (near) {
        event["near"] = {0, 0.1, 0};
        event["near_in"] = "body";
      }
      document["events"] = {event};
      Player player(read(document));
      player.step();
      const Vec3 momentum = measure_state(player).momentum;
      EXPECT_LT((momentum - Vec3(0, 0.5, -0.25)).norm(), 1e-6) << body << near;
    }
  }
}

TEST(Player, SwitchesBodiesGravityAndOverlays) {
  json document = cube_and_box();
  document["events"] = json::parse(R"([
    {"at": 0, "do": "toggle", "what": "gravity", "on": false},
    {"at": 0, "do": "toggle", "what": "body", "body": "box"},
    {"at": 0.1, "do": "toggle", "what": "body", "body": "cube", "on": false},
    {"at": 0.2, "do": "toggle", "what": "body", "body": "box"},
    {"at": 0.2, "do": "toggle", "what": "wireframe"},
    {"at": 0.3, "do": "toggle", "what": "body", "body": "cube"},
    {"at": 0.3, "do": "toggle", "what": "gravity"}])");
  Player player(read(document));
  player.step();
  EXPECT_FALSE(player.present({false, 1}));
  EXPECT_TRUE(player.present({true, 0}));
  EXPECT_FALSE(player.overlays().wireframe);
  while (player.time() < 0.25) {
    player.step();
  }
  EXPECT_TRUE(player.present({false, 1}));
  EXPECT_FALSE(player.present({true, 0}));
  EXPECT_TRUE(player.overlays().wireframe);
  EXPECT_NEAR(player.center({false, 1}).y(), 0.5, 1e-6);
  while (player.time() < 0.5) {
    player.step();
  }
  EXPECT_LT(player.center({false, 1}).y(), 0.45);
  EXPECT_LT(player.center({true, 0}).y(), 0.45);
}

TEST(Player, APluginSwitchReachesTheBody) {
  json document = cube_and_box();
  document["events"] = json::parse(R"([
    {"at": 0, "do": "toggle", "what": "plugin", "body": "cube", "switch": "gravity"}])");
  Player player(read(document));
  for (int k = 0; k < 30; ++k) {
    player.step();
  }
  EXPECT_NEAR(player.center({true, 0}).y(), 0.5, 1e-6);
}

TEST(Player, KeepsMomentumWhenACompoundSpins) {
  const json document = json::parse(R"({
    "world": {"gravity": [0, 0, 0]},
    "rigid_bodies": [{"name": "hammer", "shape": "compound", "mass": 2, "position": [1, 2, 3],
      "velocity": [1, 0, 0], "parts": [
        {"shape": "cylinder", "radius": 0.02, "length": 0.3, "axis": "x"},
        {"shape": "box", "size": [0.1, 0.1, 0.1], "position": [0.2, 0, 0]}]}],
    "frames": 1})");
  Player player(read(document));
  // Its volumes: the handle's centre at 0, the head's at 0.2.
  const double handle = M_PI * 0.02 * 0.02 * 0.3, head = 1e-3;
  EXPECT_NEAR(player.center({false, 0}).x(), 1 + 0.2 * head / (head + handle), 1e-6);
  // The head's middle, seen through the placement of its solid.
  EXPECT_LT((player.rigid(0).solid_placement(1).position - Vec3(1.2, 2, 3)).norm(), 1e-6);
  EXPECT_LT((measure_state(player).momentum - Vec3(2, 0, 0)).norm(), 1e-6);
}

}  // namespace
}  // namespace softpoint::scene
