#include "json_reader.h"

#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <fstream>
#include <random>

#include "json_document.h"
#include "nearest.h"
#include "support/refusal.h"
#include "support/temporary_folder.h"

namespace softpoint::scene {
namespace {

enum class Shape { kBox, kSphere };

// A reader that uses every getter.
struct Body {
  double mass = 0, friction = 0;
  std::optional<double> radius;
  int count = 0;
  bool visible = false;
  std::string name;
  Vec3 position = Vec3::Zero();
  std::array<std::optional<double>, 3> held;
  std::vector<int> vertices;
  std::vector<double> weights;
  std::filesystem::path mesh;
  Shape shape = Shape::kBox;
  double edge = 0;
};

void read_body(ObjectReader& reader, Body& body) {
  body.mass =
      reader.number("mass", {.quantity = Quantity::kMass, .low = 0.0, .above = true, .doc = "how heavy"});
  body.friction = reader.number("friction", {.low = 0.0, .high = 10.0, .fallback = 0.5});
  body.radius = reader.optional_number("radius", {.quantity = Quantity::kLength, .low = 0.0});
  body.count = reader.integer("count", {.low = 1, .high = 100, .fallback = 4});
  body.visible = reader.boolean("visible", {.fallback = true});
  body.name = reader.text("name", {.fallback = "body"});
  body.position = reader.vec3("position", {.quantity = Quantity::kLength, .fallback = Vec3(0.0, 0.0, 0.0)});
  if (reader.describing() || reader.has("held")) {
    body.held = reader.partial_vec3("held", {.quantity = Quantity::kLength});
    body.vertices = reader.indices("vertices", {.count = 5, .of = "vertices of the mesh"});
  }
  body.weights = reader.numbers("weights", {.low = 0.0}, {.max = 3, .optional = true});
  body.mesh = reader.file("mesh", {.fallback = "default.obj"});
  body.shape =
      reader.choice<Shape>("look", {{"box", Shape::kBox}, {"sphere", Shape::kSphere}}, {.fallback = "box"});
  reader.variant("kind",
                 {{"cube", "a cube",
                   [&](ObjectReader& r) { body.edge = r.number("edge", {.quantity = Quantity::kLength}); }},
                  {"point", "a point", [](ObjectReader&) {}}},
                 {.fallback = "point"});
}

std::vector<Body> read_scene(ObjectReader& root) {
  std::vector<Body> bodies;
  root.list("bodies", {.min = 1, .max = 4, .doc = "what there is"},
            [&](ObjectReader& item, int) { read_body(item, bodies.emplace_back()); });
  root.optional_object("camera", "where from", [](ObjectReader& camera) {
    camera.number("angle", {.quantity = Quantity::kAngle, .fallback = 1.0});
  });
  return bodies;
}

std::vector<Body> read(const std::string& text) {
  std::vector<Body> bodies;
  read_json_text(text, "scene.json", "scenes", [&](ObjectReader& root) { bodies = read_scene(root); });
  return bodies;
}

Body read_one(const std::string& members) { return read("{\"bodies\": [{" + members + "}]}").at(0); }

const char* const kFull =
    R"({"bodies": [{"mass": "2 g", "friction": 1, "radius": "3 cm", "count": 7, "visible": false,
 "name": "b\u00e4ll", "position": [1, "20 cm", -3e0], "held": [null, 0.5, "1 mm"], "vertices": [4, 0],
 "weights": [1, 2.5], "mesh": "a/b.obj", "look": "sphere", "kind": "cube", "edge": 2}, {"mass": 1}],
 "camera": {"angle": "90 deg"}})";

TEST(JsonReader, GivesWhatTheDocumentSays) {
  const std::vector<Body> bodies = read(kFull);
  ASSERT_EQ(bodies.size(), 2u);
  const Body& body = bodies[0];
  EXPECT_EQ(body.mass, 0.002);
  EXPECT_EQ(body.friction, 1.0);
  EXPECT_EQ(body.radius, 0.03);
  EXPECT_EQ(body.count, 7);
  EXPECT_FALSE(body.visible);
  EXPECT_EQ(body.name, "b\xc3\xa4ll");
  EXPECT_EQ(body.position, Vec3(1.0, 0.2, -3.0));
  EXPECT_EQ(body.held[0], std::nullopt);
  EXPECT_EQ(body.held[2], 0.001);
  EXPECT_EQ(body.vertices, (std::vector<int>{4, 0}));
  EXPECT_EQ(body.weights, (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(body.mesh, std::filesystem::path("scenes/a/b.obj"));
  EXPECT_EQ(body.shape, Shape::kSphere);
  EXPECT_EQ(body.edge, 2.0);
}

TEST(JsonReader, GivesDefaultsForAbsentKeys) {
  const Body body = read(kFull).at(1);
  EXPECT_EQ(body.friction, 0.5);
  EXPECT_EQ(body.radius, std::nullopt);
  EXPECT_EQ(body.count, 4);
  EXPECT_TRUE(body.visible);
  EXPECT_EQ(body.name, "body");
  EXPECT_EQ(body.position, Vec3(0.0, 0.0, 0.0));
  EXPECT_EQ(body.mesh, std::filesystem::path("scenes/default.obj"));
  EXPECT_TRUE(body.weights.empty());
}

TEST(JsonReader, AnAbsoluteFileNameStaysAsItIs) {
  EXPECT_EQ(read_one(R"("mass": 1, "mesh": "/a/b.obj")").mesh, std::filesystem::path("/a/b.obj"));
}

TEST(JsonReader, RefusesNamingFilePathValueAndWhatIsPermitted) {
  struct Case {
    const char* members;
    std::vector<std::string> fragments;
  };
  const std::vector<Case> cases = {
      // missing and unknown keys
      {"", {"/bodies/0: \"mass\" is missing", "mass in kg", "how heavy"}},
      {R"("mas": 1)", {"\"mass\" is missing", "there is \"mas\", did you mean \"mass\"?"}},
      {R"("mass": 1, "fricton": 2)",
       {"/bodies/0/fricton = 2: unknown key", "did you mean \"friction\"?",
        "permitted are count, friction,"}},
      {R"("mass": 1, "zzzzzzzz": {"a": [1, 2]})",
       {"/bodies/0/zzzzzzzz = {\"a\":[1,2]}: unknown key; permitted"}},
      {R"("mass": 1, "a/b~c": 2)", {"/bodies/0/a~1b~0c = 2: unknown key"}},
      {R"("mass": 1, "edge": 2)", {"/bodies/0/edge = 2: unknown key"}},
      {R"("mass": 1, "kind": "cube")", {"\"edge\" is missing"}},
      {R"("mass": 1, "kind": "cub")", {"/kind = \"cub\"", "one of cube, point", "did you mean \"cube\"?"}},
      {R"("mass": 1, "mass": 2)", {"/bodies/0/mass", "twice"}},
      // numbers
      {R"("mass": true)", {"/bodies/0/mass = true: permitted is a mass in kg"}},
      {R"("mass": null)", {"/bodies/0/mass = null: permitted is a mass in kg"}},
      {R"("mass": [1])", {"/bodies/0/mass = [1]: permitted is a mass in kg"}},
      {R"("mass": {})", {"/bodies/0/mass = {}"}},
      {R"("mass": 0)", {"/bodies/0/mass = 0: permitted is above 0 kg"}},
      {R"("mass": -1e-3)", {"/bodies/0/mass = -0.001: permitted is above 0 kg"}},
      {R"("mass": "3 m")", {"/bodies/0/mass = \"3 m\": m measures length; permitted is a mass"}},
      {R"("mass": "heavy")", {"/bodies/0/mass = \"heavy\": no number"}},
      {R"("mass": 1, "friction": 11)", {"/bodies/0/friction = 11: permitted is 0 to 10"}},
      {R"("mass": 1, "friction": "1")", {"/bodies/0/friction = \"1\"", "plain number"}},
      {R"("mass": 1, "radius": -1)", {"/bodies/0/radius = -1: permitted is 0 m or more"}},
      // integers, booleans, texts
      {R"("mass": 1, "count": 1.5)", {"/bodies/0/count = 1.5: permitted is an integer, 1 to 100"}},
      {R"("mass": 1, "count": 0)", {"/bodies/0/count = 0: permitted is an integer, 1 to 100"}},
      {R"("mass": 1, "count": 18446744073709551615)", {"/bodies/0/count", "1 to 100"}},
      {R"("mass": 1, "count": "3")", {"/bodies/0/count = \"3\""}},
      {R"("mass": 1, "visible": 1)", {"/bodies/0/visible = 1: permitted is true or false"}},
      {R"("mass": 1, "name": 1)", {"/bodies/0/name = 1: permitted is a text"}},
      {R"("mass": 1, "mesh": "")", {"/bodies/0/mesh", "name of a file"}},
      {R"("mass": 1, "mesh": "a\u0000b")", {"/bodies/0/mesh", "name of a file"}},
      {R"("mass": 1, "look": "spher")",
       {"/bodies/0/look = \"spher\"", "one of box, sphere", "did you mean \"sphere\""}},
      // vectors and lists
      {R"("mass": 1, "position": [1, 2])",
       {"/bodies/0/position = [1,2]: permitted is a list of 3: length in m"}},
      {R"("mass": 1, "position": 3)", {"/bodies/0/position = 3"}},
      {R"("mass": 1, "position": [1, 2, "3 kg"])", {"/bodies/0/position/2 = \"3 kg\": kg measures mass"}},
      {R"("mass": 1, "position": [1, null, 3])", {"/bodies/0/position/1 = null"}},
      {R"("mass": 1, "weights": [1, 2, 3, 4])", {"/bodies/0/weights", "4 of them", "0 to 3"}},
      {R"("mass": 1, "weights": [1, -2])", {"/bodies/0/weights/1 = -2: permitted is 0 or more"}},
      {R"("mass": 1, "weights": {})", {"/bodies/0/weights = {}: permitted is a list"}},
      {R"("mass": 1, "held": [1, 2, 3])", {"\"vertices\" is missing"}},
      {R"("mass": 1, "held": [1, 2, 3], "vertices": [5])",
       {"/bodies/0/vertices/0 = 5: permitted is an integer, 0 to 4: there are 5 vertices of the mesh"}},
      {R"("mass": 1, "held": [1, 2, 3], "vertices": [-1])", {"/bodies/0/vertices/0 = -1"}},
      {R"("mass": 1, "held": [1, 2, 3], "vertices": [1.0])", {"/bodies/0/vertices/0 = 1.0"}},
      {R"("mass": 1, "held": [1, 2, 3], "vertices": [2, 2])",
       {"/bodies/0/vertices/1 = 2: it stands in the list twice"}},
      {R"("mass": 1, "held": [1, 2, 3], "vertices": [])", {"/bodies/0/vertices = []", "0 of them"}},
      {R"("mass": 1, "held": [1, 2], "vertices": [2])", {"/bodies/0/held = [1,2]"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.members);
    expect_refusal([&] { read_one(c.members); }, c.fragments);
    expect_refusal([&] { read_one(c.members); }, {"scene.json: "});
  }
}

TEST(JsonReader, RefusesTheWrongOuterForm) {
  expect_refusal([] { read("[]"); }, {"scene.json: / = []: permitted is an object"});
  expect_refusal([] { read("3"); }, {"scene.json: / = 3"});
  expect_refusal([] { read("{}"); },
                 {"scene.json: /: \"bodies\" is missing", "list of objects", "1 to 4 of them"});
  expect_refusal([] { read(R"({"bodies": []})"); }, {"/bodies = []", "1 to 4"});
  expect_refusal([] { read(R"({"bodies": [7]})"); }, {"/bodies/0 = 7: permitted is an object"});
  expect_refusal([] { read(R"({"bodies": [{"mass": 1}], "camera": {"angel": 1}})"); },
                 {"/camera/angel = 1", "did you mean \"angle\"?"});
  expect_refusal([] { read(R"({"bodies": [{"mass": 1}], "camera": []})"); }, {"/camera = []"});
}

TEST(JsonDocument, RefusesSyntaxWithLineAndColumn) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"{\n  \"a\": 1,\n  \"b\" 2\n}", "scene.json:3:7: "},
      {"{\"a\": 1,}", "scene.json:1:9: "},
      {"{\"a\": NaN}", "scene.json:1:"},
      {"{\"a\": Infinity}", "scene.json:1:"},
      {"{\"a\": 1e999}", "scene.json:1:"},
      {"{\"a\": 01}", "scene.json:1:"},
      {"{\"a\": 1 // one\n}", "scene.json:1:"},
      {"/* */ {}", "scene.json:1:"},
      {"{'a': 1}", "scene.json:1:"},
      {"{} {}", "scene.json:1:"},
      {"", "scene.json:1:"},
      {"{\"a\": \"\xff\"}", "scene.json:1:"},
      {std::string("{\"a\": \0}", 8), "scene.json:1:"},
  };
  for (const auto& [text, head] : cases) {
    SCOPED_TRACE(text);
    const std::string message = refusal([&] { read(text); });
    EXPECT_EQ(message.substr(0, head.size()), head) << message;
  }
}

TEST(JsonDocument, LimitsDepth) {
  const auto nested = [](int depth) {
    return std::string("{\"bodies\": [{\"mass\": 1}], \"x\": ") + std::string(depth, '[') +
           std::string(depth, ']') + "}";
  };
  expect_refusal([&] { read(nested(63)); }, {"unknown key"});
  expect_refusal([&] { read(nested(64)); }, {"nested deeper than 64 levels"});
  expect_refusal([&] { read(std::string(1 << 20, '[')); }, {"nested deeper than 64 levels"});
}

TEST(JsonDocument, LimitsSize) {
  TemporaryFolder folder;
  const auto path = folder.path() / "large.json";
  std::ofstream(path) << "{}";
  std::filesystem::resize_file(path, kMaxDocumentBytes + 1);
  expect_refusal([&] { read_json_file(path, [](ObjectReader&) {}); }, {"large.json", "64 MiB"});
  expect_refusal([&] { read_json_file("/dev/zero", [](ObjectReader&) {}); }, {"/dev/zero", "64 MiB"});
  expect_refusal([&] { read_json_file(folder.path() / "none.json", [](ObjectReader&) {}); },
                 {"none.json", "No such file"});
  expect_refusal([&] { read_json_file(folder.path(), [](ObjectReader&) {}); }, {"folder"});
}

TEST(JsonDocument, DoesNotDependOnTheLocale) {
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
    std::setlocale(LC_ALL, locale);
    EXPECT_EQ(read_one(R"("mass": 0.1)").mass, 0.1);
    EXPECT_EQ(read_one(R"("mass": "0.1 kg")").mass, 0.1);
  }
  std::setlocale(LC_ALL, "C");
}

TEST(JsonReader, RefusesEveryTruncation) {
  const std::string full = kFull;
  for (std::size_t length = 0; length < full.size(); ++length) {
    EXPECT_THROW(read(full.substr(0, length)), Error) << length;
  }
}

TEST(JsonReader, RandomDamageNeverCrashes) {
  std::mt19937 random(3);
  const std::string full = kFull;
  const std::string alphabet = "{}[]:,\"0123456789eE+-. \\untrfalse/*\xff\x80";
  int refused = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = full;
    const int hits = 1 + static_cast<int>(random() % 4);
    for (int k = 0; k < hits; ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 8);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 16));
      }
      if (text.empty()) {
        break;
      }
    }
    try {
      for (const Body& body : read(text)) {
        ASSERT_TRUE(std::isfinite(body.mass) && body.mass > 0.0);
      }
    } catch (const Error& error) {
      ++refused;
      ASSERT_EQ(std::string(error.what()).rfind("scene.json", 0), 0u) << error.what();
    }
  }
  EXPECT_GT(refused, 10000);
}

TEST(Schema, ListsWhatTheReaderAsksFor) {
  const Schema schema = describe([](ObjectReader& root) { read_scene(root); });
  const auto entry = [&](const std::string& path) {
    for (const SchemaEntry& candidate : schema.entries) {
      if (candidate.path == path) {
        return candidate;
      }
    }
    ADD_FAILURE() << path;
    return SchemaEntry{};
  };
  EXPECT_EQ(entry("/bodies/*/mass").type, "mass in kg");
  EXPECT_EQ(entry("/bodies/*/mass").permitted, "above 0 kg");
  EXPECT_EQ(entry("/bodies/*/mass").fallback, "required");
  EXPECT_EQ(entry("/bodies/*/mass").doc, "how heavy");
  EXPECT_EQ(entry("/bodies/*/friction").fallback, "0.5");
  EXPECT_EQ(entry("/bodies/*/radius").fallback, "optional");
  EXPECT_EQ(entry("/bodies/*/look").permitted, "one of box, sphere");
  EXPECT_EQ(entry("/bodies/*/edge").when, "kind = cube");
  EXPECT_EQ(entry("/camera/angle").fallback, "1 rad");
  EXPECT_EQ(entry("/bodies").permitted, "1 to 4 of them");
  for (const std::string& text : {schema_text(schema), schema_markdown(schema)}) {
    for (const SchemaEntry& candidate : schema.entries) {
      EXPECT_NE(text.find(candidate.path), std::string::npos);
      EXPECT_NE(text.find(candidate.doc), std::string::npos);
    }
  }
}

TEST(Nearest, FindsTypingErrorsOnly) {
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
  EXPECT_EQ(edit_distance("friction", "firction"), 1);
  EXPECT_EQ(nearest("postion", {"mass", "position", "rotation"}), "position");
  EXPECT_EQ(nearest("xyzzy", {"mass", "position"}), "");
  EXPECT_EQ(nearest("ab", {"xy"}), "");
  EXPECT_EQ(nearest(std::string(10000, 'a'), {std::string(9999, 'a')}), "");
}

}  // namespace
}  // namespace softpoint::scene
