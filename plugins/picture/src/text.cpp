#include "softpoint/picture/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "font.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// In font units, multiplied by the scale.
constexpr double kAdvance = 8.6, kLineHeight = 18.0;
constexpr double kPadX = 7.0, kPadY = 4.0;
constexpr double kBaseline = 12.0;  // below the top of a line
constexpr double kPenRadius = 0.72, kDotRadius = 1.0;

// A size's glyphs as coverage, rasterised when first used.
class Glyphs {
 public:
  explicit Glyphs(double scale) : scale_(scale) {
    width_ = static_cast<int>(std::ceil(kAdvance * scale)) + 1;
    height_ = static_cast<int>(std::ceil(kLineHeight * scale));
  }
  double scale() const { return scale_; }
  int width() const { return width_; }
  int height() const { return height_; }

  const std::vector<std::uint8_t>& coverage(unsigned char character) {
    const bool known = character >= kFirstGlyph && character < kFirstGlyph + kGlyphCount;
    auto& glyph = glyphs_[static_cast<std::size_t>((known ? character : '?') - kFirstGlyph)];
    if (glyph.empty()) rasterise(character, glyph);
    return glyph;
  }

 private:
  void rasterise(unsigned char character, std::vector<std::uint8_t>& out) const {
    out.resize(static_cast<std::size_t>(width_ * height_));
    // Whole pixels at scale 1: strokes then run through pixel centres and stay crisp.
    const double left = std::floor(1.3 * scale_) + 0.5, base = std::floor(kBaseline * scale_) + 0.5;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        double inside = -1e9;  // depth within the ink, pixels
        for (const FontSegment& s : glyph_segments(character)) {
          const double ax = left + scale_ * s.ax, ay = base - scale_ * s.ay;
          const double dx = scale_ * (s.bx - s.ax), dy = -scale_ * (s.by - s.ay);
          const double px = x + 0.5 - ax, py = y + 0.5 - ay;
          const double length2 = dx * dx + dy * dy;
          const double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
          const double pen = std::max((length2 > 0 ? kPenRadius : kDotRadius) * scale_, 0.55);
          inside = std::max(inside, pen - std::hypot(px - t * dx, py - t * dy));
        }
        const double cover = std::clamp(inside + 0.5, 0.0, 1.0);
        out[static_cast<std::size_t>(y * width_ + x)] = static_cast<std::uint8_t>(std::lround(255 * cover));
      }
    }
  }

  double scale_;
  int width_, height_;
  std::array<std::vector<std::uint8_t>, kGlyphCount> glyphs_;
};

// The last few sizes used by this thread.
Glyphs& glyphs_of(double scale) {
  constexpr std::size_t kKept = 6;
  thread_local std::vector<Glyphs> kept;
  thread_local std::size_t oldest = 0;
  for (Glyphs& glyphs : kept) {
    if (glyphs.scale() == scale) return glyphs;
  }
  if (kept.size() < kKept) return kept.emplace_back(scale);
  Glyphs& replaced = kept[oldest];
  oldest = (oldest + 1) % kKept;
  return replaced = Glyphs(scale);
}

void blend(std::uint8_t* pixel, Color color, double cover) {
  const float channels[3] = {color.r, color.g, color.b};
  const double alpha = cover * std::clamp(color.a, 0.0F, 1.0F);
  for (int c = 0; c < 3; ++c) {
    const double target = 255.0 * std::clamp(channels[c], 0.0F, 1.0F);
    pixel[c] = static_cast<std::uint8_t>(std::lround(pixel[c] + alpha * (target - pixel[c])));
  }
}

int pixels(double units, double scale) { return static_cast<int>(std::lround(units * scale)); }

}  // namespace

void check(const TextStyle& style) {
  check(style.color, "text color");
  check_range("text scale", style.scale, 0.5, 16.0);
  check(style.backing, "text backing");
}

TextSize measure_text(std::string_view text, const TextStyle& style) {
  check(style);
  int lines = 1, columns = 0, column = 0;
  for (const char c : text) {
    if (c == '\n') {
      ++lines;
      column = 0;
    } else {
      columns = std::max(columns, ++column);
    }
  }
  return {pixels(columns * kAdvance + 2 * kPadX, style.scale),
          pixels(lines * kLineHeight + 2 * kPadY, style.scale)};
}

void draw_text(Image& image, int x, int y, std::string_view text, const TextStyle& style) {
  const TextSize size = measure_text(text, style);
  const auto clip = [](int from, int count, int limit) {
    return std::pair(std::clamp(-from, 0, count), std::clamp(limit - from, 0, count));
  };
  if (style.backing.a > 0) {
    const auto [x0, x1] = clip(x, size.width, image.width);
    const auto [y0, y1] = clip(y, size.height, image.height);
    for (int dy = y0; dy < y1; ++dy) {
      for (int dx = x0; dx < x1; ++dx) blend(image.pixel(x + dx, y + dy), style.backing, 1.0);
    }
  }
  Glyphs& glyphs = glyphs_of(style.scale);
  int line = 0, column = 0;
  for (const char c : text) {
    if (c == '\n') {
      ++line;
      column = 0;
      continue;
    }
    const std::vector<std::uint8_t>& coverage = glyphs.coverage(static_cast<unsigned char>(c));
    const int left = x + pixels(kPadX + kAdvance * column++, style.scale);
    const int top = y + pixels(kPadY + kLineHeight * line, style.scale);
    const auto [x0, x1] = clip(left, glyphs.width(), image.width);
    const auto [y0, y1] = clip(top, glyphs.height(), image.height);
    for (int dy = y0; dy < y1; ++dy) {
      for (int dx = x0; dx < x1; ++dx) {
        const std::uint8_t cover = coverage[static_cast<std::size_t>(dy * glyphs.width() + dx)];
        if (cover > 0) blend(image.pixel(left + dx, top + dy), style.color, cover / 255.0);
      }
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
