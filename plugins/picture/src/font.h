#pragma once

#include <string_view>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A fixed-width single-stroke font: glyphs are pen strokes, so any size is crisp. Units: capitals are 10 high
// and 6 wide, the baseline at 0, descenders down to -3.
struct FontSegment {
  float ax, ay, bx, by;
};

inline constexpr int kFirstGlyph = 32, kGlyphCount = 95;

// The pen strokes of an ASCII character from 32 to 126, curves cut into short segments; '?' for any other.
const std::vector<FontSegment>& glyph_segments(unsigned char character);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
