// Every number that documents may hold, found through the schema their readers record, tried with NaN,
// infinity, negative, zero and huge values: refused with path, value and range, or played and solved with
// finite results.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <set>

#include "document_kinds.h"
#include "picture_output.h"
#include "player.h"
#include "scene_reader.h"
#include "softpoint/core/error.h"
#include "softpoint/elastic/statics.h"
#include "static_problem_file.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace softpoint::scene {
namespace {

using nlohmann::json;

const std::filesystem::path kScenes = std::filesystem::path(SOFTPOINT_EXAMPLES_FOLDER) / "scenes";
constexpr double kInfinity = std::numeric_limits<double>::infinity();

json cube() {
  return json::parse(R"({"name": "cube", "plugin": "elastic", "position": [0, 0.3, 0],
    "mesh": {"kind": "box", "size": [0.4, 0.4, 0.4], "cells": [1, 1, 1]},
    "material": {"young": 1e5, "poisson": 0.3, "density": 500}})");
}

json scene() {
  return {
      {"rigid_bodies", {{{"shape", "plane"}, {"name", "floor"}}}}, {"deformables", {cube()}}, {"frames", 3}};
}

// Characters of every kind of shape, held and hung in every way.
std::vector<json> characters() {
  std::vector<json> all;
  json d = scene();
  d["world"] = json::parse(R"({"gravity": [0, -9.81, 0]})");
  d["deformables"].push_back(json::parse(R"({"name": "limb", "plugin": "character", "position": [0, 0.8, 0],
    "look": "solid", "material": {"young": 1e5, "poisson": 0.3, "density": 500},
    "inertia": false, "weight": true, "reaction": true,
    "joints": {"method": "equilibrium", "tolerance": 1e-3, "max_iterations": 12, "kappa": 0,
      "predictor": "automatic", "ik_sweeps": 10, "precision": "single", "surface_turns": true},
    "shapes": [{"name": "link", "kind": "prism", "sides": 3, "stacks": 2, "radius": 0.05, "length": 0.1}],
    "parts": [{"name": "arm", "segments": [{"shape": "link", "count": 2}], "root": [0, 0, 0], "axis": [1, 0, 0],
      "roll": 0.1, "color": [1, 0, 0],
      "bone": {"length_stiffness": 10, "angle_stiffness": 1, "mass": 0.1, "damping": 1}}],
    "exoskeleton": "cube", "attachments": [{"part": "arm", "end": "root", "vertex": 1},
      {"part": "arm", "end": "tip", "near": [0.2, 0.5, 0.2]}]})"));
  all.push_back(d);
  d = scene();
  d["deformables"].push_back(json::parse(R"({"name": "limb", "plugin": "character", "position": [0, 0.8, 0],
    "inertia": true, "joints": {"method": "richardson", "max_iterations": 5, "precision": "double"},
    "material": {"young": 1e5, "poisson": 0.3, "density": 500},
    "shapes": [
      {"name": "block", "kind": "box", "cells": [4, 4, 4], "size": [0.4, 0.4, 0.4],
        "patches": [{"name": "side", "side": "+x", "cells": 2, "radius": 0.1, "along": 0, "across": 0}]},
      {"name": "link", "kind": "prism", "sides": 8, "stacks": 2, "radius": 0.1, "length": 0.2}],
    "parts": [{"name": "trunk", "segments": [{"shape": "block"}]},
      {"name": "arm", "segments": [{"shape": "link"}], "root": [0.2, 0, 0.2], "axis": [1, 0, 0]}],
    "joins": [{"part": "arm", "end": "root", "to": "trunk", "segment": 0, "patch": "side"}],
    "holds": [{"part": "trunk", "end": "root", "by": "point"}]})"));
  all.push_back(d);
  d["deformables"][1]["joints"] = json::parse(R"({"precision": "double"})");
  d["events"] = json::parse(R"([
    {"at": 0, "do": "hold", "handle": "h", "body": "limb", "part": "arm", "end": "tip", "by": "surface"},
    {"at": 0, "do": "move", "handle": "h", "to": [0.4, 1, 0.2], "duration": 0.5, "turn": [0, 0, 1]}])");
  all.push_back(d);
  d["events"][1] = json::parse(R"({"at": 0, "do": "move", "handle": "h",
    "keyframes": [{"time": 0.5, "position": [0.4, 1, 0.2], "turn": [0, 0, 1]}]})");
  all.push_back(d);
  d = scene();
  d["deformables"].push_back(json::parse(R"({"name": "gem", "plugin": "character", "position": [0, 0.8, 0],
    "material": {"young": 1e5}, "holds": [{"part": "gem", "end": "root"}],
    "shapes": [{"name": "gem", "kind": "obj", "file": "gem.obj", "scale": 1,
      "interfaces": [{"vertices": [0, 1, 2]}, {"vertices": [3, 4, 5]}]}],
    "parts": [{"name": "gem", "segments": [{"shape": "gem"}]}]})"));
  all.push_back(d);
  return all;
}

// Cloths cut from every kind of pattern.
std::vector<json> cloths() {
  std::vector<json> all;
  json d = scene();
  d["deformables"][0] = json::parse(R"({"name": "cube", "plugin": "cloth", "position": [0, 0.01, 0],
    "pattern": {"kind": "square", "points": [4, 4], "size": [0.2, 0.2], "lumping": "area",
      "bumps": [{"at": [0, 0, 0], "radius": 0.08, "height": 0.02}]},
    "fabric": {"weave": "satin", "fiber": "silk", "area_density": 0.1, "warp_stiffness": 1e4, "weft_stiffness": 1e4,
      "shear_stiffness": 100, "bending_stiffness": 1e-5, "compression_ratio": 0.1, "damping_time": 1e-4,
      "drag_rate": 1, "thickness": 3e-4},
    "wetness": {"saturation": 1, "capacity": 0.7, "friction_factor": 3, "warp_factor": 1, "weft_factor": 1,
      "shear_factor": 1, "bending_factor": 1, "paint": [{"at": [0.1, 0, 0], "radius": 0.05, "saturation": 0.5}]},
    "air": {"bubbles": "found", "ambient": 101325, "initial_volume": 1e-4, "touch_gap": 3e-4, "release_gap": 1e-3,
      "lifetime": 3, "min_thickness": 1e-5, "limit_suction": true, "surface_tension": 0.07, "contact_angle": 0,
      "pore_diameter": 5e-5, "vapour_pressure": 2340, "leak": true, "permeability": 1e-3, "vent": true,
      "viscosity": 18e-6, "film_gap": 2e-4, "bridge_gap": 2.7e-3, "rim_width": 5e-3, "wet": 0.3, "adhesion": true},
    "solver": {"dial": "default", "max_substep": 1e-3, "march_step": 7e-5, "max_move": 0.25, "max_substeps": 40, "sweeps": 2,
      "coarse_every": 1, "coarse_points": 7, "guard": true, "precision": "double"},
    "self_contact": {"on": true, "friction": 0.3}})");
  all.push_back(d);
  d["deformables"][0]["paper"] =
      json::parse(R"({"step": 1e-5, "pressure": "constant_area", "friction": "forces",
    "sphere_diameter": 0.01, "sphere_friction": 0.3, "simd": true, "precision": "double"})");
  d["deformables"][0]["air"]["bubbles"] = "one";
  d["deformables"][0]["pattern"].erase("bumps");
  all.push_back(d);
  d["deformables"][0].erase("paper");
  d["deformables"][0]["air"]["bubbles"] = "found";
  d["deformables"][0]["pattern"] = json::parse(R"({"kind": "sphere", "radius": 0.1, "subdivisions": 0})");
  d["deformables"][0]["position"] = {0, 0.2, 0};
  all.push_back(d);
  d["deformables"][0]["pattern"] = json::parse(R"({"kind": "obj", "file": "gem.obj", "scale": 1})");
  d["deformables"][0]["position"] = {0, 1, 0};
  all.push_back(d);
  return all;
}

// Keyframed figures of all kinds of joints, placed by every rule.
std::vector<json> figures() {
  std::vector<json> all;
  json d = scene();
  d["rigid_bodies"].push_back(
      json::parse(R"({"shape": "box", "size": [0.5, 0.2, 0.5], "position": [1, 0.1, 0]})"));
  d["figures"] =
      json::parse(R"([{"name": "doll", "color": [1, 0, 0], "mode": "exact", "frame_time": 0.02, "substeps": 1,
    "contact_friction": 0.8, "interpolation": "cubic", "key_times": [0, 0.1, 0.2], "end": 0.2,
    "links": [
      {"name": "trunk", "joint": "free", "from": [0, 0, 0], "tip": [0, 0.4, 0], "radius": 0.1, "mass": 10},
      {"name": "arm", "parent": "trunk", "axis": [1, 0, 0], "origin": [0.2, 0.4, 0], "tip": [0, -0.3, 0],
        "radius": 0.04, "mass": 1, "lower": -1, "upper": "170 deg", "armature": 0.01, "damping": 0.02,
        "dry_friction": 0.01, "friction": 0.8},
      {"name": "head", "parent": "trunk", "joint": "ball", "origin": [0, 0.5, 0], "tip": [0, 0.2, 0], "mass": 3,
        "axis": [0, 1, 0], "lower": -0.6, "upper": 0.6, "swing_about": 0.7, "swing_across": 0.4,
        "swing_axis": [1, 0, 0]},
      {"name": "rod", "parent": "trunk", "joint": "prismatic", "axis": [0, 1, 0], "tip": [0, -0.5, 0], "mass": 1},
      {"name": "foot", "parent": "rod", "joint": "fixed", "origin": [0, -0.5, 0], "tip": [0, 0, 0.2], "mass": 1}],
    "base": [{"position": [0, 1, 0], "turn": [0, 0, 0]}, {"position": [0, 1, 0.1], "turn": [0, "20 deg", 0]},
      {"position": [0, 1.1, 0.2], "turn": [0, 0, 0.1]}],
    "joints": [{"joint": "arm", "values": [0, 0.5, "60 deg"]}, {"joint": "rod", "values": [0, 0.02, 0]},
      {"joint": "head", "values": [0, 0, 0, 0.1, 0, 0, 0.2, 0, 0]}],
    "dynamic": [{"begin": 0.1, "end": 0.2, "limb": "arm"}],
    "handovers": [{"time": 0.01, "limb": "trunk"}, {"time": 0.02, "limb": "arm", "dynamic": false}],
    "places": [{"begin": 0, "end": 0.1, "rule": "pin", "link": "foot", "point": [0, 0, 0.1]}]}])");
  all.push_back(d);
  json& doll = d["figures"][0];
  doll["places"][0] = json::parse(R"({"begin": 0, "end": 0.2, "rule": "contact", "link": "foot"})");
  doll["dynamic"][0] = json::parse(R"({"begin": 0, "end": 0.2, "limb": "trunk"})");
  all.push_back(d);
  doll["places"][0] =
      json::parse(R"({"begin": 0, "end": 0.2, "rule": "hold", "link": "foot", "other": "arm"})");
  all.push_back(d);
  doll["places"][0].erase("other");
  doll["mode"] = "paper";
  doll["links"][1].erase("dry_friction");
  doll["places"][0]["rule"] = "gravity";
  doll["dynamic"][0]["limb"] = "arm";
  all.push_back(d);
  doll["places"][0] =
      json::parse(R"({"begin": 0, "end": 0.1, "rule": "feet", "link": "foot", "other": "arm"})");
  doll.erase("dynamic");
  all.push_back(d);
  d["figures"] = json::parse(R"([{"end": 0.1, "model": {"file": "stroll.bvh", "base": "auto", "scale": 0.01,
    "density": 1000, "thickness": 0.1, "up": "z", "position": [0, 0, 0]}}])");
  all.push_back(d);
  return all;
}

// Small documents that hold all keys between them.
std::vector<json> scenes() {
  std::vector<json> all;
  json d = scene();
  d["world"] = json::parse(R"({"kind": "discrete", "gravity": [0, -9.81, 0], "time_step": 0.01, "substeps": 1,
    "solver_iterations": 4, "contact": {"margin": 1e-3, "tolerance": 1e-6, "max_iterations": 50, "max_passes": 4,
    "rebound_speed": 0.2, "rigid_support": true}})");
  d["camera"] = json::parse(R"({"eye": [3, 2, 4], "target": [0, 0.5, 0], "up": [0, 1, 0], "fov": 0.7})");
  d["pictures"] =
      json::parse(R"({"every": 1, "times": [0.02], "size": {"width": 32, "height": 16}, "sheet": true,
    "sheet_columns": 2, "sheet_cell_width": 16, "contacts": true, "forces": true, "meters_per_newton": 0.002,
    "wireframe": true, "time": true, "text": "t"})");
  d["video"] = json::parse(R"({"fps": 60, "quality": 20})");
  d.erase("frames");
  d["duration"] = 0.03;
  d["description"] = "all of the frame";
  all.push_back(d);
  d = scene();
  d["camera"] =
      json::parse(R"({"timing": "linear", "keyframes": [{"time": 0, "eye": [3, 2, 4], "target": [0, 0, 0]},
    {"time": 1, "eye": [2, 2, 4], "target": [0, 0, 0]}]})");
  d["pictures"] = json::parse(R"({"every": 1, "size": {"width": 32, "height": 16}, "sheet_cell_width": 16})");
  all.push_back(d);
  const char* const shapes[] = {
      R"({"shape": "box", "size": [0.2, 0.2, 0.2]})",
      R"({"shape": "sphere", "radius": 0.1})",
      R"({"shape": "capsule", "radius": 0.1, "length": 0.2})",
      R"({"shape": "cylinder", "radius": 0.1, "length": 0.2, "axis": "x"})",
      R"({"shape": "cone", "radius": 0.1, "length": 0.2})",
      R"({"shape": "hull", "file": "gem.obj", "scale": 1})",
  };
  const char* const turns[] = {R"({"axis": [0, 1, 0], "angle": 0.3})", R"({"euler": [0.1, 0.2, 0.3]})",
                               R"({"quaternion": [0, 0, 0.1, 1]})"};
  int k = 0;
  json compound = {{"shape", "compound"}, {"mass", 2}, {"position", {0, 1.2, 0}}};
  for (const char* shape : shapes) {
    json body = json::parse(shape);
    json part = body;
    part["position"] = {0.3 * k, 0, 0};
    part["orientation"] = json::parse(turns[k % 3]);
    compound["parts"].push_back(part);
    body.update(json::parse(R"({"name": "rigid", "mass": 1, "position": [0, 0.8, 0], "velocity": [0, -1, 0],
      "angular_velocity": [0, 1, 0], "friction": 0.5, "restitution": 0, "rolling_friction": 0,
      "linear_damping": 0, "angular_damping": 0, "color": [1, 0, 0]})"));
    body["orientation"] = json::parse(turns[k % 3]);
    d = scene();
    d["rigid_bodies"].push_back(body);
    all.push_back(d);
    ++k;
  }
  d = scene();
  d["rigid_bodies"].push_back(compound);
  // A mesh never moves and is no part of a compound.
  d["rigid_bodies"].push_back(json::parse(
      R"({"name": "ground", "shape": "mesh", "file": "gem.obj", "scale": 1, "position": [5, 0, 0]})"));
  all.push_back(d);
  d = scene();
  d["rigid_bodies"][0].update(json::parse(R"({"normal": [0, 1, 0], "offset": 0})"));
  all.push_back(d);
  const char* const meshes[] = {
      R"({"kind": "sphere", "radius": 0.2, "subdivisions": 0})",
      R"({"kind": "box", "size": [0.4, 0.4, 0.4], "cells": [1, 1, 1]})",
      R"({"kind": "prism", "sides": 4, "stacks": 1, "cap_rings": 1, "radius": 0.2, "length": 0.4})",
      R"({"kind": "capsule", "radius": 0.1, "length": 0.1, "sectors": 4, "stacks": 1, "rings": 2})",
      R"({"kind": "hollow_sphere", "outer_radius": 0.2, "inner_radius": 0.1, "subdivisions": 0})",
      R"({"kind": "obj", "file": "gem.obj", "scale": 1})",
  };
  k = 0;
  for (const char* mesh : meshes) {
    d = scene();
    json& body = d["deformables"][0];
    body["mesh"] = json::parse(mesh);
    body.update(json::parse(R"({"velocity": [0, -1, 0], "angular_velocity": [0, 1, 0], "friction": 0.5,
      "restitution": 0, "color": [1, 0, 0]})"));
    body["orientation"] = json::parse(turns[k++ % 3]);
    all.push_back(d);
  }
  const char* const events[] = {
      R"([{"at": 0, "do": "grab", "handle": "h", "body": "cube", "vertex": 1, "max_force": 10},
          {"at": 0, "do": "move", "handle": "h", "to": [0, 1, 0], "duration": 0.5}])",
      R"([{"at": 0, "do": "grab", "handle": "h", "body": "cube", "near": [0, 0, 0]},
          {"at": 0, "do": "move", "handle": "h", "keyframes": [{"time": 0.5, "position": [0, 1, 0]}]}])",
      R"([{"at": 0, "do": "pin", "handle": "h", "body": "cube", "vertices": [1]}])",
      R"([{"at": 0, "do": "pin", "handle": "h", "body": "cube", "near": [0, 0, 0], "radius": 0.1}])",
      R"([{"at": 0, "do": "attach", "handle": "h", "body": "cube", "to": "floor", "vertices": [1], "max_force": 10,
          "collide": true}])",
      R"([{"at": 0, "do": "attach", "handle": "h", "body": "cube", "to": "floor", "near": [0, 0, 0], "radius": 0.1}])",
      R"([{"at": 0, "do": "impulse", "body": "cube", "impulse": [0, 1, 0], "near": [0, 0, 0]}])",
      R"([{"at": 0, "do": "toggle", "what": "gravity", "on": false}])",
  };
  for (const char* list : events) {
    d = scene();
    d["events"] = json::parse(list);
    all.push_back(d);
  }
  for (json& character : characters()) all.push_back(std::move(character));
  for (json& cloth : cloths()) all.push_back(std::move(cloth));
  for (json& figure : figures()) all.push_back(std::move(figure));
  return all;
}

std::vector<json> problems() {
  return {json::parse(R"({"mesh": "gem.obj", "material": {"young": 1e5, "poisson": 0.3, "density": 500},
    "displacement": [{"vertices": [0, 1, 2], "value": [0, 0, 0]}], "traction": [{"faces": [3], "value": [10, 0, 0]}],
    "gravity": [0, -9.81, 0]})")};
}

// A number in a document.
struct Place {
  json::json_pointer pointer;
  std::string text;  // as in messages
};

// All places in `document` that a path of the schema ("/bodies/*/mass") leads to, where its condition holds.
void find_places(const json& at, const std::string& pattern, const SchemaEntry& entry,
                 json::json_pointer here, std::set<std::string> facts, std::vector<Place>& places) {
  if (at.is_object()) {
    for (const auto& [key, value] : at.items()) {
      if (value.is_string()) facts.insert(key + " = " + value.get<std::string>());
    }
  }
  if (pattern.empty()) {
    std::string rest = entry.when;
    while (!rest.empty()) {
      const auto comma = rest.find(", ");
      if (!facts.contains(rest.substr(0, comma))) return;
      rest = comma == std::string::npos ? "" : rest.substr(comma + 2);
    }
    if (at.is_array()) {
      for (std::size_t k = 0; k < at.size(); ++k) places.push_back({here / k, (here / k).to_string()});
    } else {
      places.push_back({here, here.to_string()});
    }
    return;
  }
  const auto slash = pattern.find('/', 1);
  const std::string token = pattern.substr(1, slash == std::string::npos ? slash : slash - 1);
  const std::string rest = slash == std::string::npos ? "" : pattern.substr(slash);
  if (token == "*") {
    for (std::size_t k = 0; at.is_array() && k < at.size(); ++k) {
      find_places(at[k], rest, entry, here / k, facts, places);
    }
  } else if (at.is_object() && at.contains(token)) {
    find_places(at.at(token), rest, entry, here / token, facts, places);
  }
}

// The text of the document with `literal` in place of the number.
std::string with(json document, const Place& place, const std::string& literal) {
  document[place.pointer] = "<here>";
  std::string text = document.dump();
  return text.replace(text.find("\"<here>\""), 8, literal);
}

std::string number(double value) { return json(value).dump(); }

struct Trials {
  std::vector<std::string> refused, permitted;
};

Trials trials_of(const NumberLimits& limits) {
  Trials trials;
  trials.refused = {"\"nan\"", "\"inf\"", "\"1e999\"", "true", "{}", "\"\""};
  const auto inside = [&](double x) {
    return x >= limits.low && x <= limits.high && !(limits.above && x == limits.low);
  };
  std::vector<double> values = {-1e300,
                                -1.0,
                                0.0,
                                5e-324,
                                1e300,
                                limits.low,
                                limits.high,
                                std::nextafter(limits.low, -kInfinity),
                                std::nextafter(limits.high, kInfinity)};
  if (limits.integer) {
    values = {-2147483649.0,  -1.0,           0.0, 2147483648.0, 1e15, limits.low, limits.high,
              limits.low - 1, limits.high + 1};
    trials.refused.insert(trials.refused.end(), {"0.5", "1e+300", "1e+20"});
  }
  for (const double x : values) {
    const std::string text = limits.integer ? std::to_string(static_cast<long long>(x)) : number(x);
    (inside(x) ? trials.permitted : trials.refused).push_back(text);
  }
  return trials;
}

class EveryField : public ::testing::Test {
 protected:
  EveryField() { ::setenv("SOFTPOINT_CACHE_DIR", (folder_.path() / "cache").c_str(), 1); }

  // `work` reads a text and does what the program does with it; false when a result is not finite.
  void expect_every_number(const std::string& command, const std::vector<json>& documents,
                           const std::function<bool(const std::string&, const std::string& place)>& work) {
    for (const DocumentKind& kind : document_kinds()) {
      if (kind.command != command) continue;
      for (const SchemaEntry& entry : kind.schema.entries) {
        if (!entry.limits) continue;
        SCOPED_TRACE(entry.path + (entry.when.empty() ? "" : " if " + entry.when));
        EXPECT_TRUE(std::isfinite(entry.limits->low) && std::isfinite(entry.limits->high))
            << "a number without limits can be so large that what is computed from it overflows";
        int count = 0;
        for (const json& document : documents) {
          std::vector<Place> places;
          find_places(document, entry.path, entry, json::json_pointer(), {}, places);
          for (const Place& place : places) {
            ++count;
            // The same reader each time.
            if (count <= by_tier(4, 2, 1)) expect_at(document, place, entry, work);
          }
        }
        EXPECT_GT(count, 0) << "no document of this test holds this key: add it to one";
      }
    }
  }

  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

 private:
  static void expect_at(const json& document, const Place& place, const SchemaEntry& entry,
                        const std::function<bool(const std::string&, const std::string&)>& work) {
    const Trials trials = trials_of(*entry.limits);
    for (const char* literal : {"NaN", "Infinity", "-Infinity", "nan", "1e999"}) {
      expect_refused(document, place, literal, work, {"finite numbers"});
    }
    for (const std::string& literal : trials.refused) {
      std::vector<std::string> fragments = {literal, "permitted"};
      const bool counted = entry.path.ends_with("/vertex") || entry.type.starts_with("list of integers");
      const bool is_number = literal.find_first_not_of("-+.e0123456789") == std::string::npos;
      if (is_number && !counted) {
        for (const double end : {entry.limits->low, entry.limits->high}) {
          fragments.push_back(entry.limits->integer ? std::to_string(static_cast<long long>(end))
                                                    : to_text(end));
        }
      }
      expect_refused(document, place, literal, work, fragments);
    }
    for (const std::string& literal : trials.permitted) {
      SCOPED_TRACE(place.text + " = " + literal);
      try {
        EXPECT_TRUE(work(with(document, place, literal), place.text))
            << "a permitted value, but not all is finite";
      } catch (const Error& error) {
        // For what it does together with other keys; the message says what would do.
        const std::string message = error.what();
        EXPECT_TRUE(message.find("permitted") != std::string::npos ||
                    message.find("twice") != std::string::npos)
            << message;
      }
    }
  }

  static void expect_refused(const json& document, const Place& place, const std::string& literal,
                             const std::function<bool(const std::string&, const std::string&)>& work,
                             std::vector<std::string> fragments) {
    SCOPED_TRACE(place.text + " = " + literal);
    fragments.push_back(place.text);
    try {
      work(with(document, place, literal), place.text);
      ADD_FAILURE() << "it was taken";
    } catch (const Error& error) {
      const std::string message = error.what();
      for (const std::string& fragment : fragments) {
        EXPECT_NE(message.find(fragment), std::string::npos)
            << "message: " << message << "\nlacks: " << fragment;
      }
    }
  }

  TemporaryFolder folder_;
};

bool is_finite(const btVector3& v) {
  return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z());
}

bool is_finite(const Player& player) {
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    for (const Vec3& x : player.deformable(k).points()) {
      if (!x.allFinite()) return false;
    }
    for (const Vec3& v : player.deformable(k).velocities()) {
      if (!v.allFinite()) return false;
    }
  }
  for (std::size_t k = 0; k < player.rigid_count(); ++k) {
    const btRigidBody& body = player.rigid(k).body();
    if (!is_finite(body.getWorldTransform().getOrigin()) || !is_finite(body.getLinearVelocity()) ||
        !is_finite(body.getAngularVelocity())) {
      return false;
    }
  }
  for (std::size_t k = 0; k < player.figure_count(); ++k) {
    const figure::FigureAnimation& animation = player.figure(k).animation();
    for (int frame = 0; frame < animation.frame_count(); ++frame) {
      for (const double x : animation.frame(frame).q) {
        if (!std::isfinite(x)) return false;
      }
      for (const double x : animation.frame(frame).qd) {
        if (!std::isfinite(x)) return false;
      }
    }
  }
  return player.system().profile().totals.guard_fired == 0;
}

TEST_F(EveryField, OfScenesIsRefusedOrPlaysFinitely) {
  const DeformablePlugins plugins = deformable_plugins();
  expect_every_number("play", scenes(), [&](const std::string& text, const std::string& place) {
    Scene read;
    read_json_text(text, "scene.json", kScenes, [&](ObjectReader& root) { read_scene(root, plugins, read); });
    // The largest counts make meshes of a million vertices: read and checked, but not assembled.
    for (const DeformableSpec& body : read.deformables) {
      if (body.vertex_count > 200) return true;
    }
    read.frames = std::min(read.frames, 3);
    const bool pictured = place.starts_with("/camera") || place.starts_with("/pictures");
    Player player(std::move(read));
    std::unique_ptr<PictureOutput> pictures;  // none in a build without the picture plugin
    if (pictured) {
      const PictureSpec& spec = player.scene().pictures;
      pictures = make_picture_output(player, {file("out"), spec.width, spec.height, true, false});
    }
    while (player.frame() < player.scene().frames) {
      player.step();
      if (pictures) pictures->take();
    }
    if (pictures) pictures->finish();
    return is_finite(player);
  });
}

TEST_F(EveryField, OfProblemsIsRefusedOrSolvedFinitely) {
  expect_every_number("solve", problems(), [&](const std::string& text, const std::string&) {
    elastic::StaticProblem problem;
    read_json_text(text, "problem.json", kScenes,
                   [&](ObjectReader& root) { read_static_problem(root, problem); });
    static_result_json(elastic::solve_statics(problem));  // refuses what is not finite
    return true;
  });
}

}  // namespace
}  // namespace softpoint::scene
