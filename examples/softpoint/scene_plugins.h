#pragma once

#include <functional>
#include <string>
#include <vector>

#include "json_reader.h"
#include "scene.h"

// How a plugin brings its deformables into scenes. The readers and the player know this interface only;
// scene_plugins.cpp is the one place where plugins are named.
namespace softpoint::inline SOFTPOINT_ABI::scene {

// What a plugin makes of the keys of one deformable.
struct DeformablePlan {
  int vertex_count = 0;
  MakeDeformable make;
};

struct DeformablePlugin {
  std::string name;  // the text at "plugin"
  std::string doc;
  std::vector<std::string> switches;  // what {"do": "toggle", "what": "plugin"} may name
  // Asks for the plugin's own keys. While describing, the plan is not used.
  std::function<DeformablePlan(ObjectReader&)> read;
};

using DeformablePlugins = std::vector<DeformablePlugin>;

// All that this program was built with.
DeformablePlugins deformable_plugins();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
