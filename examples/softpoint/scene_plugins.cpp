#include "scene_plugins.h"

#include "scene_character.h"
#include "scene_cloth.h"
#include "scene_elastic.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

DeformablePlugins deformable_plugins() { return {elastic_plugin(), character_plugin(), cloth_plugin()}; }

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
