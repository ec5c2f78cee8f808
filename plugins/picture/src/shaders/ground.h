#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A fan of triangles round the eye's foot on the plane. `plane`: unit normal and the eye's height over the
// plane; `axis_u`, `axis_v`: the grid's directions over its spacing, w: the eye's place on the grid, reduced
// to [0, 10); `paint`: linear colour, w: 1 with grid lines; `reach`: radius of the fan.
inline constexpr std::string_view kGroundVertex = R"(
layout(location = 0) in vec2 disc;
uniform vec4 plane, axis_u, axis_v, reach;
out vec3 position;
void main() {
  position = -plane.w * plane.xyz + reach.x * (disc.x * normalize(axis_u.xyz) + disc.y * normalize(axis_v.xyz));
  gl_Position = projection * vec4(position, 1.0);
}
)";

// The grid is filtered in closed form: a pixel sees the integral of the line pattern over its footprint.
inline constexpr std::string_view kGroundFragment = R"(
in vec3 position;
uniform vec4 plane, axis_u, axis_v, paint, reach;
out vec4 result;

// Integral from 0 to x of a pattern of period 1 that is 1 within `half_width` of the integers.
vec2 line_integral(vec2 x, float half_width) {
  vec2 cell = floor(x + 0.5);
  return 2.0 * half_width * cell + clamp(x - cell, -half_width, half_width);
}

float line_cover(vec2 x, vec2 footprint, float half_width) {
  vec2 cover = (line_integral(x + 0.5 * footprint, half_width) - line_integral(x - 0.5 * footprint, half_width)) /
               footprint;
  return 1.0 - (1.0 - cover.x) * (1.0 - cover.y);
}

void main() {
  vec3 color = paint.rgb;
  vec2 grid = vec2(dot(position, axis_u.xyz) + axis_u.w, dot(position, axis_v.xyz) + axis_v.w);
  vec2 footprint = max(1.2 * (abs(dFdx(grid)) + abs(dFdy(grid))), 1e-5);
  if (paint.w > 0.0) {
    color *= 1.0 - 0.22 * line_cover(grid, footprint, 0.012) - 0.25 * line_cover(0.1 * grid, 0.1 * footprint, 0.002);
  }
  vec3 lit = color * diffuse_light(plane.xyz, shadow_factor(position, plane.xyz));
  float distance = length(position) / reach.y;
  float haze = 1.0 - exp2(-distance * distance);
  result = display(mix(lit, sky_horizon.rgb, haze));
}
)";

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
