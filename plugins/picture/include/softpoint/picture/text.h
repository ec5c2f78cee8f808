#pragma once

#include <string_view>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Text in the built-in fixed-width font: ASCII 32 to 126 and '\n'; any other byte shows as '?'.
struct TextStyle {
  Color color{0.13F, 0.15F, 0.18F};        // of the letters
  double scale = 1;                        // 1: lines 18 pixels apart; 0.5 to 16
  Color backing{1.0F, 1.0F, 1.0F, 0.70F};  // plate under the text; opacity 0 for none
};

// Throws Error naming the field.
SOFTPOINT_API void check(const TextStyle& style);

// Size of a text on its plate.
struct TextSize {
  int width = 0;   // pixels, backing included
  int height = 0;  // pixels, backing included
};

SOFTPOINT_API TextSize measure_text(std::string_view text, const TextStyle& style = {});

// Draws onto `image`, the plate's top left corner at (x, y) pixels; what lies outside is clipped.
SOFTPOINT_API void draw_text(Image& image, int x, int y, std::string_view text, const TextStyle& style = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
