#pragma once

#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// The lighting shared by meshes and ground: in front of their fragment shaders.
//
// shadow_factor(): percentage-closer filtering (Reeves, Salesin, Cook 1987) over a disc of taps spread by the
// golden angle (Vogel 1979), turned from pixel to pixel. Four taps on the rim decide whether the pixel lies
// in a penumbra at all; only then the rest is taken. shade(): Lambert and GGX (Walter et al. 2007) under one
// light, hemisphere light, Schlick's Fresnel sky.
inline constexpr std::string_view kLighting = R"(
uniform sampler2DShadow shadow_map;

float shadow_factor(vec3 position, vec3 normal) {
  if (to_light.w == 0.0) return 1.0;
  // A disc of radius r on a plane tilted by theta against the light differs from its middle by r tan(theta) in
  // depth; moving along the normal by r sin(theta) gains r sin(theta) / cos(theta): no plane shadows itself.
  float cosine = dot(normal, to_light.xyz);
  float lift = shadow_shape.y + shadow_shape.z * sqrt(max(1.0 - cosine * cosine, 0.0));
  vec3 p = (shadow * vec4(position + normal * lift, 1.0)).xyz;
  float depth = min(p.z, 1.0);
  vec2 margin = min(p.xy, 1.0 - p.xy);
  bool inside = min(margin.x, margin.y) > 0.0;
  float radius = shadow_shape.x;
  float sum = 0.0;
  int rim = inside ? 4 : 0;
  for (int i = 0; i < rim; ++i) {
    vec2 tap = vec2(i < 2 ? 0.92 : -0.92, 0.0);
    tap = (i & 1) == 0 ? tap : tap.yx;
    sum += texture(shadow_map, vec3(p.xy + radius * tap, depth));
  }
  if (rim == 0) sum = 4.0;
  int rest = sum > 0.01 && sum < 3.99 ? 12 : 0;
  // A direction of the pixel's own, then on by the golden angle.
  float turn = 2.0 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 1.0;
  vec2 direction = vec2(1.0 - turn * turn, 2.0 * turn) / (1.0 + turn * turn);
  for (int i = 0; i < rest; ++i) {
    vec2 tap = sqrt((float(i) + 0.5) / 13.0) * direction;
    direction = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688) * direction;
    sum += texture(shadow_map, vec3(p.xy + radius * tap, depth));
  }
  return sum / float(4 + rest);
}

// Sky, ground and light on a surface of normal n, as far as it scatters them evenly.
vec3 diffuse_light(vec3 n, float visibility) {
  float facing_up = 0.5 + 0.5 * dot(n, world_up.xyz);
  vec3 hemisphere = mix(bounce.rgb, sky_zenith.rgb * 0.28 + sky_horizon.rgb * 0.17, facing_up);
  return hemisphere + light_color.rgb * (visibility * max(dot(n, to_light.xyz), 0.0));
}

vec3 shade(vec3 albedo, vec3 n, vec3 to_eye, float roughness, float wetness, float visibility) {
  float rough = mix(roughness, 0.14, wetness);
  vec3 base = albedo * (1.0 - 0.35 * wetness);
  float n_l = max(dot(n, to_light.xyz), 0.0);
  float n_v = max(dot(n, to_eye), 0.03);
  vec3 light = light_color.rgb * (visibility * n_l);

  vec3 h = normalize(to_light.xyz + to_eye);
  float n_h = max(dot(n, h), 0.0);
  float alpha2 = rough * rough * rough * rough;
  float d = n_h * n_h * (alpha2 - 1.0) + 1.0;
  float highlight = min(alpha2 / (d * d) * 0.08 / mix(n_v, 1.0, 0.5), 6.0) * 0.25;

  float grazing = 1.0 - n_v;
  float fresnel = 0.04 + (0.5 + 0.4 * wetness) * (1.0 - rough) * grazing * grazing * grazing * grazing * grazing;
  vec3 away = reflect(-to_eye, n);
  vec3 mirrored = sky(away) * smoothstep(-0.3, 0.4, dot(away, world_up.xyz));
  return base * diffuse_light(n, visibility) + light * highlight * (1.0 + 2.0 * wetness) +
         mirrored * fresnel * (0.35 + 0.65 * wetness);
}
)";

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
