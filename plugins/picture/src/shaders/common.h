#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// In front of every shader: the frame's constants (frame_block.h) and the colour of the sky.
inline constexpr std::string_view kShaderPrologue = R"(#version 330 core
layout(std140) uniform Frame {
  mat4 projection;
  mat4 shadow;
  vec4 ray_right;
  vec4 ray_up;
  vec4 ray_forward;
  vec4 world_up;
  vec4 viewport;
  vec4 to_light;
  vec4 light_color;
  vec4 sky_zenith;
  vec4 sky_horizon;
  vec4 bounce;
  vec4 shadow_shape;
};

vec3 sky(vec3 direction) {
  float height = dot(direction, world_up.xyz);
  float rest = 1.0 / (1.0 + 2.0 * max(height, 0.0));
  float t = 1.0 - rest * rest;
  return mix(sky_horizon.rgb, sky_zenith.rgb, t);
}

// Linear light to the value that is stored: a shoulder that keeps highlights from clipping, then the power 1/2.2 to
// within 0.0033 by roots, which cost less than pow and are rounded alike everywhere.
vec4 display(vec3 linear) {
  vec3 over = max(linear - 0.75, 0.0);
  vec3 bent = min(linear, 0.75) + 0.25 * over / (over + 0.25);
  vec3 root = sqrt(bent);
  return vec4(0.9711214 * root + 0.0866107 * sqrt(root) - 0.0577321 * bent, 1.0);
}
)";

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
