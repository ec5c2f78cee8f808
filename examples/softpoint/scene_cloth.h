#pragma once

#include "scene_plugins.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Wet or dry cloth that traps air: a sheet, or any surface.
DeformablePlugin cloth_plugin();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
