#include "scene_reader.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "document_kinds.h"
#include "support/refusal.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

const std::filesystem::path kExamples = SOFTPOINT_EXAMPLES_FOLDER;

Scene read_example(const json& document) {
  Scene scene;
  const DeformablePlugins plugins = deformable_plugins();
  read_json_text(document.dump(), "scene.json", kExamples / "scenes",
                 [&](ObjectReader& root) { read_scene(root, plugins, scene); });
  return scene;
}

json valid() {
  return json::parse(R"({
    "rigid_bodies": [
      {"name": "floor", "shape": "plane"},
      {"name": "crate", "shape": "box", "size": [0.2, 0.2, 0.2], "mass": 1, "position": [0, 2, 0]}],
    "deformables": [
      {"name": "cube", "plugin": "elastic", "mesh": {"kind": "box", "size": [0.2, 0.2, 0.2], "cells": [1, 1, 1]},
       "material": {"young": "1e5 Pa"}, "position": [0, 1, 0]}],
    "events": [
      {"at": 0.1, "do": "grab", "handle": "hand", "body": "cube", "vertex": 3},
      {"at": 0.2, "do": "move", "handle": "hand", "from": "handle", "to": [0, "20 cm", 0], "duration": 0.5},
      {"at": 0.9, "do": "release", "handle": "hand"}],
    "frames": 60
  })");
}

TEST(SceneReader, TakesAllScenesOfTheExamples) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kExamples / "scenes")) {
    if (entry.path().extension() == ".json") {
      const Scene scene = read_scene(entry.path());
      EXPECT_GT(scene.frames, 0) << entry.path();
      ++count;
    }
  }
  EXPECT_GE(count, 5);
}

TEST(SceneReader, UnderstandsUnitsPlacesAndDefaults) {
  json document = valid();
  document["rigid_bodies"][1]["orientation"] = {{"axis", {0, 0, 2}}, {"angle", "90 deg"}};
  document["rigid_bodies"][1]["velocity"] = {"36 km/h", 0, 0};
  document["world"] = {{"kind", "deformable"}, {"time_step", "10 ms"}, {"substeps", 4}};
  document.erase("frames");
  document["duration"] = 0.5;
  const Scene scene = read_example(document);
  const RigidBodySpec& crate = scene.rigid_bodies[1];
  EXPECT_LT((crate.placement.rotation * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(crate.motion.linear, Vec3(10, 0, 0));
  EXPECT_EQ(scene.world.kind, WorldKind::kDeformable);
  EXPECT_DOUBLE_EQ(scene.world.substep(), 0.0025);
  EXPECT_EQ(scene.frames, 50);
  EXPECT_EQ(scene.world.gravity, Vec3(0, -9.81, 0));
  EXPECT_EQ(scene.deformables[0].vertex_count, 8);
}

TEST(SceneReader, AllThreeFormsOfAnOrientationAgree) {
  std::vector<Mat3> rotations;
  for (const json& form : {json{{"axis", {1, 0, 0}}, {"angle", "60 deg"}}, json{{"euler", {"60 deg", 0, 0}}},
                           json{{"quaternion", {1, 0, 0, std::sqrt(3.0)}}}}) {
    json document = valid();
    document["rigid_bodies"][1]["orientation"] = form;
    rotations.push_back(read_example(document).rigid_bodies[1].placement.rotation);
  }
  EXPECT_LT((rotations[0] - rotations[1]).norm(), 1e-15);
  EXPECT_LT((rotations[0] - rotations[2]).norm(), 1e-15);
}

TEST(SceneReader, PutsEventsInOrderOfTime) {
  json document = valid();
  std::swap(document["events"][1], document["events"][2]);
  const Scene scene = read_example(document);
  EXPECT_TRUE(std::is_sorted(scene.events.begin(), scene.events.end(),
                             [](const Event& a, const Event& b) { return a.at < b.at; }));
}

struct Spoilt {
  const char* what;
  void (*spoil)(json&);
  std::vector<std::string> fragments;
};

class SceneRefusal : public ::testing::TestWithParam<Spoilt> {};

TEST_P(SceneRefusal, NamesFilePlaceValueAndWhatIsPermitted) {
  json document = valid();
  GetParam().spoil(document);
  std::vector<std::string> fragments = GetParam().fragments;
  fragments.push_back("scene.json: ");
  expect_refusal([&] { read_example(document); }, fragments);
}

const Spoilt kSpoilt[] = {
    {"UnknownKey", [](json& d) { d["wrld"] = 1; }, {"/wrld = 1", "did you mean \"world\""}},
    {"UnknownKeyOfABody",
     [](json& d) { d["rigid_bodies"][1]["radius"] = 1; },
     {"/rigid_bodies/1/radius = 1", "permitted are", "size"}},
    {"UnknownPlugin",
     [](json& d) { d["deformables"][0]["plugin"] = "elastc"; },
     {"/deformables/0/plugin = \"elastc\"", "one of elastic"}},
    {"UnknownPluginKey",
     [](json& d) { d["deformables"][0]["material"]["yong"] = 1; },
     {"/deformables/0/material/yong"}},
    {"WrongUnit",
     [](json& d) { d["deformables"][0]["material"]["young"] = "3 kg"; },
     {"/deformables/0/material/young = \"3 kg\"", "kg measures mass", "Pa"}},
    {"WrongType",
     [](json& d) { d["rigid_bodies"][1]["mass"] = true; },
     {"/rigid_bodies/1/mass = true", "mass in kg"}},
    {"OutOfRange",
     [](json& d) { d["rigid_bodies"][1]["restitution"] = 2; },
     {"/rigid_bodies/1/restitution = 2", "0 to 1"}},
    {"UnknownShape",
     [](json& d) { d["rigid_bodies"][1]["shape"] = "bx"; },
     {"/rigid_bodies/1/shape = \"bx\"", "one of box", "did you mean \"box\""}},
    {"UnknownWorld",
     [](json& d) {
       d["world"] = {{"kind", "soft"}};
     },
     {"/world/kind = \"soft\"", "softrigid"}},
    {"PlaneWithMass",
     [](json& d) { d["rigid_bodies"][0]["mass"] = 1; },
     {"/rigid_bodies/0/mass = 1", "never moves"}},
    {"StaticWithVelocity",
     [](json& d) {
       d["rigid_bodies"][0]["velocity"] = {1, 0, 0};
     },
     {"/rigid_bodies/0", "never moves"}},
    {"TwoOrientations",
     [](json& d) {
       d["rigid_bodies"][1]["orientation"] = {{"euler", {0, 0, 0}}, {"quaternion", {0, 0, 0, 1}}};
     },
     {"/rigid_bodies/1/orientation", "one of"}},
    {"MissingMesh",
     [](json& d) {
       d["deformables"][0]["mesh"] = {{"kind", "obj"}, {"file", "none.obj"}};
     },
     {"/deformables/0/mesh", "none.obj", "No such file"}},
    {"SameName", [](json& d) { d["rigid_bodies"][1]["name"] = "floor"; }, {"/rigid_bodies/1/name", "unique"}},
    {"UnknownBodyInEvent",
     [](json& d) { d["events"][0]["body"] = "cub"; },
     {"/events/0/body = \"cub\"", "permitted are cube", "did you mean \"cube\""}},
    {"RigidBodyGrabbed",
     [](json& d) { d["events"][0]["body"] = "crate"; },
     {"/events/0/body = \"crate\"", "no deformable of that name", "cube"}},
    {"VertexOutOfRange", [](json& d) { d["events"][0]["vertex"] = 8; }, {"/events/0/vertex = 8", "0 to 7"}},
    {"UnknownHandle",
     [](json& d) { d["events"][1]["handle"] = "hnd"; },
     {"/events/1/handle = \"hnd\"", "hand"}},
    {"MoveAfterRelease",
     [](json& d) { d["events"][1]["at"] = 2; },
     {"/events/1", "\"hand\" holds nothing at 2 s"}},
    {"GrabTwice",
     [](json& d) {
       d["events"].push_back(d["events"][0]);
       d["events"][3]["at"] = 0.5;
     },
     {"/events/3", "already holds"}},
    {"SwitchedOffBodyGrabbed",
     [](json& d) {
       d["events"].push_back(
           {{"at", 0}, {"do", "toggle"}, {"what", "body"}, {"body", "cube"}, {"on", false}});
     },
     {"/events/0", "switched off"}},
    {"UnknownSwitch",
     [](json& d) {
       d["events"].push_back(
           {{"at", 0}, {"do", "toggle"}, {"what", "plugin"}, {"body", "cube"}, {"switch", "magic"}});
     },
     {"/events/3/switch = \"magic\"", "one of gravity"}},
    {"KeyframesOutOfOrder",
     [](json& d) {
       d["events"][1].erase("to");
       d["events"][1].erase("duration");
       d["events"][1]["keyframes"] = {{{"time", 1}, {"position", {0, 0, 0}}},
                                      {{"time", 1}, {"position", {0, 0, 0}}}};
     },
     {"/events/1/keyframes/1/time", "rising"}},
    {"CameraAtItsTarget",
     [](json& d) {
       d["camera"] = {{"eye", {1, 1, 1}}, {"target", {1, 1, 1}}};
     },
     {"/camera/eye", "target"}},
    {"FollowsNobody",
     [](json& d) {
       d["camera"] = {{"follow", "ghost"}};
     },
     {"/camera/follow = \"ghost\"", "crate"}},
    {"NoLength", [](json& d) { d.erase("frames"); }, {"one of: duration, frames"}},
    {"TwoLengths", [](json& d) { d["duration"] = 1; }, {"one of: duration, frames"}},
};

INSTANTIATE_TEST_SUITE_P(Scene, SceneRefusal, ::testing::ValuesIn(kSpoilt),
                         [](const auto& test) { return std::string(test.param.what); });

// The document says what the readers read.
TEST(SceneSchema, StandsInTheReadmeOfTheExamplesWhole) {
  std::ifstream in(kExamples / "README.md");
  const std::string readme{std::istreambuf_iterator<char>(in), {}};
  for (const DocumentKind& kind : document_kinds()) {
    EXPECT_NE(readme.find(schema_markdown(kind.schema)), std::string::npos)
        << "the table of " << kind.title << " in examples/README.md is not what `softpoint schema "
        << kind.command << " --markdown` prints";
  }
}

}  // namespace
}  // namespace softpoint::scene
