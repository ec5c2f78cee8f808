#include "scene_character_shapes.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "json_document.h"
#include "json_reader_state.h"
#include "nearest.h"
#include "scene_limits.h"
#include "softpoint/core/error.h"
#include "softpoint/core/obj.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

constexpr int kMaxSides = 200, kMaxStacks = 200, kMaxCells = 32, kMaxPatchOffset = 1000;

double read_length(ObjectReader& reader, std::string_view key, const std::string& doc) {
  return reader.number(key,
                       {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength, .doc = doc});
}

void read_prism(ObjectReader& reader, NamedShape& shape) {
  const int sides = reader.integer("sides", {.low = 3, .high = kMaxSides, .fallback = 16});
  const int stacks =
      reader.integer("stacks", {.low = 1, .high = kMaxStacks, .fallback = 4, .doc = "layers of the side"});
  const double radius = read_length(reader, "radius", "of the corners");
  const double length = read_length(reader, "length", "along the bone");
  if (!reader.describing()) {
    shape.shape = elastic::prism_shape(sides, stacks, radius, length);
  }
}

void read_box(ObjectReader& reader, NamedShape& shape) {
  const auto cells = reader.numbers("cells", {.low = 1, .high = kMaxCells},
                                    {.min = 3, .max = 3, .doc = "across (two, even) and along the bone"});
  const Vec3 size = reader.vec3(
      "size", {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength, .doc = "whole edges"});
  std::vector<elastic::BoxPatch> patches;
  reader.list("patches", {.optional = true, .doc = "discs in the sides, for the ends of limbs"},
              [&](ObjectReader& item, int) {
                elastic::BoxPatch patch;
                shape.patches.push_back(item.text("name", {.doc = "for joins"}));
                patch.side = item.choice<elastic::BoxSide>("side",
                                                           {{"-x", elastic::BoxSide::kLowX},
                                                            {"+x", elastic::BoxSide::kHighX},
                                                            {"-y", elastic::BoxSide::kLowY},
                                                            {"+y", elastic::BoxSide::kHighY}},
                                                           {.doc = "of the box in its own frame"});
                patch.cells = item.integer(
                    "cells",
                    {.low = 2,
                     .high = kMaxCells,
                     .fallback = 2,
                     .doc = "of the grid across the disc, even: it fits a prism of 4 times as many sides"});
                patch.radius = read_length(item, "radius", "of the disc and of the prism that fits");
                patch.along = item.integer("along", {.low = -kMaxPatchOffset,
                                                     .high = kMaxPatchOffset,
                                                     .fallback = 0,
                                                     .doc = "cells from the side's middle along the bone"});
                patch.across = item.integer("across", {.low = -kMaxPatchOffset,
                                                       .high = kMaxPatchOffset,
                                                       .fallback = 0,
                                                       .doc = "cells from the side's middle across it"});
                patches.push_back(patch);
              });
  if (reader.describing()) {
    return;
  }
  std::array<int, 3> counts{};
  for (std::size_t k = 0; k < 3; ++k) {
    counts[k] = static_cast<int>(cells[k]);
    if (cells[k] != counts[k]) {
      reader.refuse("cells", "permitted are whole numbers");
    }
  }
  shape.shape = elastic::box_shape(counts, size, patches);
}

// Vertices of the faces that stand under "g name" in an OBJ file, by rising index.
std::vector<int> obj_group(const std::filesystem::path& file, const std::string& name, int vertex_count) {
  std::istringstream lines(read_text_file(file));
  std::vector<int> vertices;
  bool inside = false;
  int read = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "v") {
      ++read;
    } else if (word == "g") {
      inside = false;
      while (words >> word) inside = inside || word == name;
    } else if (word == "f" && inside) {
      while (words >> word) {
        int index = 0;
        std::from_chars(word.data(), word.data() + word.size(), index);
        const int v = index < 0 ? read + index : index - 1;
        if (v >= 0 && v < vertex_count) vertices.push_back(v);
      }
    }
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// The vertex nearest to the middle of all goes first: the bone runs through it.
void middle_first(const TriangleMesh& mesh, std::vector<int>& vertices) {
  Vec3 middle = Vec3::Zero();
  const auto at = [&](int v) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v)]; };
  for (const int v : vertices) middle += at(v) / static_cast<double>(vertices.size());
  const auto nearest = std::min_element(vertices.begin(), vertices.end(), [&](int a, int b) {
    return (at(a) - middle).squaredNorm() < (at(b) - middle).squaredNorm();
  });
  std::rotate(vertices.begin(), nearest, nearest + 1);
}

void read_obj_shape(ObjectReader& reader, NamedShape& shape) {
  const auto file = reader.file("file", {.doc = "OBJ, metres; a closed surface"});
  const double scale = reader.number(
      "scale", {.low = 1.0 / kMaxScale, .high = kMaxScale, .fallback = 1.0, .doc = "factor on all lengths"});
  TriangleMesh& mesh = shape.shape.mesh;
  if (!reader.describing()) {
    mesh = transformed(read_obj(file), scale * Mat3::Identity(), Vec3::Zero());
  }
  reader.list("interfaces", {.min = 2, .doc = "joining surfaces: root, tip, then patches"},
              [&](ObjectReader& item, int index) {
                const std::string name = item.text("name", {.fallback = "", .doc = "of a patch, for joins"});
                if (index >= 2) shape.patches.push_back(name);
                const std::string group =
                    item.text("group", {.fallback = "",
                                        .doc = "name of a group (g) of the file: the vertices of its faces, "
                                               "the middle one on the bone; or vertices"});
                std::vector<int> vertices;
                if (item.has("vertices") || item.describing()) {
                  vertices = item.indices("vertices", {.count = item.describing() ? 1 : mesh.vertex_count(),
                                                       .of = "vertices of the mesh",
                                                       .min = 3,
                                                       .doc = "the first one on the bone; or group"});
                }
                if (item.describing()) return;
                if (group.empty() == vertices.empty()) {
                  item.refuse("permitted is one of: group, vertices");
                }
                if (vertices.empty()) {
                  vertices = obj_group(file, group, mesh.vertex_count());
                  if (vertices.size() < 3) {
                    item.refuse("group", "the file has " + std::to_string(vertices.size()) +
                                             " vertices in this group; permitted are 3 or more");
                  }
                  middle_first(mesh, vertices);
                }
                shape.shape.interfaces.push_back(std::move(vertices));
              });
}

// A closed surface with free vertices.
void check_whole(const elastic::SegmentShape& shape) {
  check_closed(shape.mesh);
  std::size_t joined = 0;
  for (const auto& interface : shape.interfaces) joined += interface.size();
  if (joined >= shape.mesh.vertices.size()) {
    throw Error("every vertex lies on a joining surface; permitted are shapes with free vertices between");
  }
}

}  // namespace

int find_name(ObjectReader& item, std::string_view key, const std::string& name,
              const std::vector<std::string>& names) {
  if (item.describing()) {
    return 0;
  }
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const std::string meant = nearest(name, names);
    item.refuse(key, (names.empty() ? "there are none to name; permitted are none"
                                    : "permitted is one of " + joined(names)) +
                         (meant.empty() ? "" : "; did you mean \"" + meant + "\"?"));
  }
  return static_cast<int>(found - names.begin());
}

std::vector<NamedShape> read_segment_shapes(ObjectReader& item) {
  std::vector<NamedShape> shapes;
  item.list("shapes", {.min = 1, .doc = "of segments; bones run along z"}, [&](ObjectReader& reader, int) {
    NamedShape shape;
    shape.name = reader.text("name", {.doc = "for segments"});
    for (const NamedShape& other : shapes) {
      if (other.name == shape.name) {
        reader.refuse("name", "another shape has it too; permitted are unique names");
      }
    }
    const auto keep = [&](void (*read)(ObjectReader&, NamedShape&)) {
      return [&shape, read](ObjectReader& kind) {
        try {
          read(kind, shape);
          if (!kind.describing()) check_whole(shape.shape);
        } catch (const Error& error) {
          // What the readers refuse says where already.
          const std::string message = error.what();
          if (message.starts_with(kind.document() + ": /")) throw;
          kind.refuse(message);
        }
      };
    };
    reader.variant("kind",
                   {{"prism", "over a regular polygon; the ends are its caps", keep(read_prism)},
                    {"box", "a grid; the ends are its low and high z sides", keep(read_box)},
                    {"obj", "from a file", keep(read_obj_shape)}},
                   {});
    shapes.push_back(std::move(shape));
  });
  return shapes;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
