#pragma once

#include "json_reader.h"
#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// "events" into scene.events and scene.handles; bodies are known already.
void read_events(ObjectReader& root, Scene& scene);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
