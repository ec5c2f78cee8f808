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
  std::vector<std::string> parts;       // as in DeformableSpec
  std::vector<std::string> taken_ends;  // as in DeformableSpec
  MakeDeformable make;
};

struct DeformablePlugin {
  std::string name;  // the text at "plugin"
  std::string doc;
  std::vector<std::string> switches;  // what {"do": "toggle", "what": "plugin"} may name
  // Asks for the plugin's own keys; `scene` holds the bodies before this one. While describing, the plan is
  // not used.
  std::function<DeformablePlan(ObjectReader&, const Scene& scene)> read;
};

using DeformablePlugins = std::vector<DeformablePlugin>;

// All that this program was built with.
DeformablePlugins deformable_plugins();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
