#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// What every shader knows of the frame; the C++ face of the GLSL block "Frame" in shaders/common.h
// (std140: only mat4 and vec4, column by column). Positions are relative to the eye, colours linear.
struct FrameBlock {
  float projection[16];
  float shadow[16];    // to shadow-map texture coordinates and depth
  float ray_right[4];  // picture axes times the tangent of half the field of view
  float ray_up[4];     // w: near depth, metres
  float ray_forward[4];
  float world_up[4];
  float viewport[4];  // width, height, 1 / width, 1 / height
  float to_light[4];  // w: 1 with shadows, else 0
  float light_color[4];
  float sky_zenith[4];
  float sky_horizon[4];
  float bounce[4];        // light from below
  float shadow_shape[4];  // kernel radius (texture units), least normal offset (m), kernel radius (m)
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
