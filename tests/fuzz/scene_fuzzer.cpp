// Scenes of `softpoint play`: read, and built where they are small.
#include <nlohmann/json.hpp>

#include "fuzz/fuzz_support.h"
#include "player.h"
#include "scene_reader.h"
#include "softpoint/core/error.h"

using namespace softpoint;

namespace {

using nlohmann::json;

// Counts that the reader permits, but that make meshes of a million vertices.
bool is_costly(const json& value, const std::string& key, int depth = 0) {
  if (depth > 64) return false;  // refused for that
  if (value.is_number()) {
    const double number = value.get<double>();
    return (key == "subdivisions" && number > 2) ||
           ((key == "cells" || key == "sides" || key == "stacks" || key == "cap_rings" || key == "sectors" ||
             key == "rings") &&
            number > 20);
  }
  for (const auto& item : value.items()) {
    if (value.is_structured() && is_costly(item.value(), value.is_array() ? key : item.key(), depth + 1))
      return true;
  }
  return false;
}

bool is_tiny(const scene::Scene& scene) {
  int vertices = 0;
  for (const scene::DeformableSpec& body : scene.deformables) vertices += body.vertex_count;
  return vertices <= 12 && scene.rigid_bodies.size() <= 20;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool without_cache = ::setenv("SOFTPOINT_CACHE_DIR", "", 1) == 0;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (!without_cache || size > 1 << 14 || fuzz::names_devices(text)) return 0;
  const json document = json::parse(text, nullptr, false);
  if (!document.is_discarded() && document.is_structured() && is_costly(document, "")) return 0;
  try {
    static const scene::DeformablePlugins plugins = scene::deformable_plugins();
    scene::Scene read;
    scene::read_json_text(text, "scene.json", SOFTPOINT_SCENES_FOLDER,
                          [&](scene::ObjectReader& root) { scene::read_scene(root, plugins, read); });
    fuzz::require(read.frames > 0, "a scene has frames");
    if (is_tiny(read)) const scene::Player player(std::move(read));
  } catch (const Error&) {
  }
  return 0;
}
