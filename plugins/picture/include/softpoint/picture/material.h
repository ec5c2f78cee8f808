#pragma once

#include <string_view>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// How a surface looks.
struct Material {
  Color color{0.72F, 0.72F, 0.70F};  // opacity is ignored: meshes are opaque
  double roughness = 0.55;           // 0.05 (mirror-like highlight) to 1 (chalk); clamped to these
  double wetness = 0;                // 0 dry to 1 soaked: darker, with a sharp sheen; clamped to these
  bool two_sided = false;            // draw the inside of open surfaces too
  bool casts_shadow = true;          // onto others and itself
  bool wireframe = false;            // draw the edges of the triangles on top
};

// Throws Error naming the field unless its numbers are finite.
SOFTPOINT_API void check(const Material& material, std::string_view name = "material");

// The i-th of an endless row of well-distinguishable colours of even lightness (i >= 0).
SOFTPOINT_API Color palette_color(int i);

// The colours of things that never move, and of floors.
inline constexpr Color kStaticColor{0.66F, 0.66F, 0.64F};
inline constexpr Color kGroundColor{0.77F, 0.76F, 0.74F};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
