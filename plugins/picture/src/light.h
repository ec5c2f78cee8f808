#pragma once

#include "frame_block.h"
#include "softpoint/picture/renderer.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Unit vector towards the light of `settings`, seen against the world's up.
Vec3 direction_to_light(const RenderSettings& settings, const Vec3& world_up);

// Everything of the frame's constants but projection and shadow.
void fill_light(FrameBlock& block, const View& view, const RenderSettings& settings, const Vec3& to_light);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
