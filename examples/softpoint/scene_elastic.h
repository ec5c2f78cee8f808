#pragma once

#include "scene_plugins.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Free elastic bodies: softpoint::elastic.
DeformablePlugin elastic_plugin();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
