#pragma once

#include "scene_plugins.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Articulated elastic characters: rows of elastic segments along bones, joined to each other, held by hands
// or hung on an exoskeleton.
DeformablePlugin character_plugin();

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
