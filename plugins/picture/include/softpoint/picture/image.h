#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A colour as one writes it in a style sheet: sRGB-encoded, each channel 0 to 1. Values outside are clamped.
struct Color {
  float r = 0;  // red
  float g = 0;  // green
  float b = 0;  // blue
  float a = 1;  // opacity
};

// Throws Error naming "<name> r" and so on unless all four are finite.
SOFTPOINT_API void check(const Color& color, std::string_view name = "color");

// Rows from the top, four bytes a pixel (red, green, blue, opacity), sRGB-encoded.
struct Image {
  int width = 0;                   // pixels
  int height = 0;                  // pixels
  std::vector<std::uint8_t> rgba;  // 4 width height bytes

  Image() = default;
  // All of one colour.
  SOFTPOINT_API Image(int width, int height, Color fill = {});

  // The four bytes of column x, row y from the top; not checked.
  // @{
  std::uint8_t* pixel(int x, int y) { return rgba.data() + offset(x, y); }
  const std::uint8_t* pixel(int x, int y) const { return rgba.data() + offset(x, y); }
  // @}
  // Same size and bytes.
  bool operator==(const Image&) const = default;

 private:
  std::size_t offset(int x, int y) const {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
  }
};

// Each pixel of the result is the mean of the rectangle of `image` it covers (box filter, exact for
// fractional ratios too). Only shrinks: 1 <= width <= image.width, height likewise, else Error.
SOFTPOINT_API Image shrink(const Image& image, int width, int height);

// Peak signal-to-noise ratio over red, green and blue in dB; infinite for equal pictures. Throws Error when
// the sizes differ.
SOFTPOINT_API double psnr(const Image& a, const Image& b);

// 64-bit FNV-1a of size and pixels, for golden pictures.
SOFTPOINT_API std::uint64_t hash(const Image& image);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
