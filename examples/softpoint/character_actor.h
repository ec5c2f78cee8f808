#pragma once

#include "scene.h"
#include "scene_character_parts.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The character of a plan in play. Throws Error as Character does.
DeformableActor make_character(const CharacterPlan& plan, const MakeContext& context);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
