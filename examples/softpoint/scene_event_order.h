#pragma once

#include <string>
#include <vector>

#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Goes through the events in order of time, whatever their order in the file, and refuses one whose handle
// holds nothing, or too much, or whose body is switched off by then. `places` name the events in messages.
void check_event_order(const Scene& scene, const std::vector<std::string>& places);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
