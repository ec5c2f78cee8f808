#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Attributes 0, 1 a vertex; 2 to 6 an instance: rows of the affine map to eye-relative coordinates, linear
// colour and roughness, wetness.
inline constexpr std::string_view kMeshVertex = R"(
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec3 vertex_normal;
layout(location = 2) in vec4 row_x;
layout(location = 3) in vec4 row_y;
layout(location = 4) in vec4 row_z;
layout(location = 5) in vec4 color_roughness;
layout(location = 6) in float wet;
out vec3 position;
out vec3 normal;
flat out vec4 surface;
flat out float wetness;
void main() {
  vec4 v = vec4(vertex, 1.0);
  position = vec3(dot(row_x, v), dot(row_y, v), dot(row_z, v));
  // Normals go by the matrix of cofactors, whose rows are the cross products of the rows.
  normal = vec3(dot(cross(row_y.xyz, row_z.xyz), vertex_normal), dot(cross(row_z.xyz, row_x.xyz), vertex_normal),
                dot(cross(row_x.xyz, row_y.xyz), vertex_normal));
  surface = color_roughness;
  wetness = wet;
  gl_Position = projection * vec4(position, 1.0);
}
)";

inline constexpr std::string_view kMeshFragment = R"(
in vec3 position;
in vec3 normal;
flat in vec4 surface;
flat in float wetness;
out vec4 result;
void main() {
  vec3 n = normalize(normal);
  if (!gl_FrontFacing) n = -n;
  vec3 to_eye = normalize(-position);
  result = display(shade(surface.rgb, n, to_eye, surface.a, wetness, shadow_factor(position, n)));
}
)";

inline constexpr std::string_view kShadowVertex = R"(
layout(location = 0) in vec3 vertex;
layout(location = 2) in vec4 row_x;
layout(location = 3) in vec4 row_y;
layout(location = 4) in vec4 row_z;
void main() {
  vec4 v = vec4(vertex, 1.0);
  vec3 p = (shadow * vec4(dot(row_x, v), dot(row_y, v), dot(row_z, v), 1.0)).xyz;
  gl_Position = vec4(2.0 * p - 1.0, 1.0);
}
)";

inline constexpr std::string_view kShadowFragment = R"(
void main() {}
)";

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
