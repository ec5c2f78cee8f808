#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// One triangle over the whole picture, at the far end of the depth range.
inline constexpr std::string_view kSkyVertex = R"(
out vec3 ray;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  ray = ray_forward.xyz + corner.x * ray_right.xyz + corner.y * ray_up.xyz;
  gl_Position = vec4(corner, 1.0, 1.0);
}
)";

inline constexpr std::string_view kSkyFragment = R"(
in vec3 ray;
out vec4 result;
void main() { result = display(sky(normalize(ray))); }
)";

// A segment as a strip `width` pixels wide; attributes 0 to 3 an instance. Each end is pulled towards the eye
// by a thousandth of its distance, which changes nothing in the picture plane and lifts the line off its
// surface.
inline constexpr std::string_view kLineVertex = R"(
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec4 color;
layout(location = 3) in float width;
flat out vec4 paint;
void main() {
  vec3 a = 0.999 * from, b = 0.999 * to;
  // Cut the segment at the near plane, before dividing by depth.
  float near = ray_up.w;
  float depth_a = dot(a, ray_forward.xyz), depth_b = dot(b, ray_forward.xyz);
  bool hidden = depth_a < near && depth_b < near;
  if (depth_a < near) a = mix(a, b, (near - depth_a) / (depth_b - depth_a));
  if (depth_b < near) b = mix(b, a, (near - depth_b) / (depth_a - depth_b));
  vec4 clip_a = projection * vec4(a, 1.0), clip_b = projection * vec4(b, 1.0);
  vec2 pixel_a = clip_a.xy / clip_a.w * viewport.xy * 0.5, pixel_b = clip_b.xy / clip_b.w * viewport.xy * 0.5;
  vec2 along = pixel_b - pixel_a;
  float span = length(along);
  along = span > 1e-6 ? along / span : vec2(1.0, 0.0);
  float side = (gl_VertexID & 1) == 0 ? -0.5 : 0.5;
  bool at_b = gl_VertexID >= 2;
  vec2 shift = (side * vec2(-along.y, along.x) + (at_b ? 0.35 : -0.35) * along) * width;
  vec4 clip = at_b ? clip_b : clip_a;
  paint = color;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(clip.xy + shift * 2.0 * viewport.zw * clip.w, clip.zw);
}
)";

inline constexpr std::string_view kFlatFragment = R"(
flat in vec4 paint;
out vec4 result;
void main() { result = paint; }
)";

// A disc shaded like a small ball; attributes 0 to 2 an instance.
inline constexpr std::string_view kPointVertex = R"(
layout(location = 0) in vec3 center;
layout(location = 1) in vec4 color;
layout(location = 2) in float radius;
flat out vec4 paint;
flat out float pixels;
out vec2 place;
void main() {
  vec4 clip = projection * vec4(0.998 * center, 1.0);
  place = vec2((gl_VertexID & 1) == 0 ? -1.0 : 1.0, gl_VertexID < 2 ? -1.0 : 1.0) * (radius + 1.0) / radius;
  paint = color;
  pixels = radius;
  gl_Position = vec4(clip.xy + place * radius * 2.0 * viewport.zw * clip.w, clip.zw);
}
)";

inline constexpr std::string_view kPointFragment = R"(
flat in vec4 paint;
flat in float pixels;
in vec2 place;
out vec4 result;
void main() {
  float r = length(place);
  float cover = clamp((1.0 - r) * pixels + 0.5, 0.0, 1.0);
  if (cover == 0.0) discard;
  float light = 0.72 + 0.28 * dot(vec3(place, sqrt(max(1.0 - r * r, 0.0))), vec3(-0.4, 0.6, 0.69));
  result = vec4(paint.rgb * light, paint.a * cover);
}
)";

inline constexpr std::string_view kTriangleVertex = R"(
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec4 color;
flat out vec4 paint;
void main() {
  paint = color;
  gl_Position = projection * vec4(0.9995 * vertex, 1.0);
}
)";

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
