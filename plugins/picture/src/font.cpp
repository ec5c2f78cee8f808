#include "font.h"

#include <array>
#include <cstddef>

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// One text a glyph, ASCII 32 to 126: strokes apart by blanks; a point is a digit (x) and a letter (y from
// a = -3 over d = 0, the baseline, to n = 10). A leading ~ makes the points the control polygon of a
// quadratic B-spline, a leading @ of a closed one.
constexpr std::array<std::string_view, kGlyphCount> kStrokes = {
    "",                                         // space
    "3n3g 3d3d",                                // !
    "2n2k 4n4k",                                // "
    "2d2n 4d4n 0g6g 0k6k",                      // #
    "~6k6m0m0i6i6e0e0g 3n3d",                   // $
    "0d6n @0k2k2n0n @4d6d6g4g",                 // %
    "~6d1j1n5n5j0h0d4d6h",                      // &
    "3n3k",                                     // '
    "~4n2k2e4b",                                // (
    "~2n4k4e2b",                                // )
    "3l3f 1k5g 1g5k",                           // *
    "3k3e 0h6h",                                // +
    "3d2b",                                     // ,
    "1h5h",                                     // -
    "3d3d",                                     // .
    "0c6n",                                     // /
    "@0d6d6n0n 2g4k",                           // 0
    "1l3n3d 1d5d",                              // 1
    "~0l0n6n6j0d 0d6d",                         // 2
    "~0l0n6n6i2i ~2i6i6d0d0f",                  // 3
    "5d5n0g6g",                                 // 4
    "6n1n0i ~0i1j6k6d0d0f",                     // 5
    "@0d6d6j0j ~0g0l2n5n",                      // 6
    "0n6n2d",                                   // 7
    "@1i5i5n1n @0d6d6i0i",                      // 8
    "@0h6h6n0n ~6k6f4d1d",                      // 9
    "3j3j 3e3e",                                // :
    "3j3j 3e2b",                                // ;
    "5l0h5d",                                   // <
    "0j6j 0f6f",                                // =
    "1l6h1d",                                   // >
    "~0l0n6n6j3i3f 3d3d",                       // ?
    "@2g4g4k2k ~4k4g6g6n0n0d5d",                // @
    "0d3n6d 1g5g",                              // A
    "0d0n 0n3n 0i3i 0d3d ~3n5n5i3i ~3i6i6d3d",  // B
    "~6l6n0n0d6d6f",                            // C
    "0d0n ~0n3n6n6d3d0d",                       // D
    "6n0n0d6d 0i5i",                            // E
    "6n0n0d 0i5i",                              // F
    "~6l6n0n0d6d6h 6h4h",                       // G
    "0d0n 6d6n 0i6i",                           // H
    "3d3n 1n5n 1d5d",                           // I
    "5n5g ~5g5d0d0f",                           // J
    "0d0n 6n0h 2j6d",                           // K
    "0n0d6d",                                   // L
    "0d0n3h6n6d",                               // M
    "0d0n6d6n",                                 // N
    "@0d6d6n0n",                                // O
    "0d0n 0n3n 0h3h ~3n6n6h3h",                 // P
    "@0d6d6n0n 4f6c",                           // Q
    "0d0n 0n3n 0h3h ~3n6n6h3h 3h6d",            // R
    "~6l6n0n0i6i6d0d0f",                        // S
    "0n6n 3n3d",                                // T
    "0n0g ~0g0d6d6g 6g6n",                      // U
    "0n3d6n",                                   // V
    "0n1d3j5d6n",                               // W
    "0d6n 0n6d",                                // X
    "0n3i6n 3i3d",                              // Y
    "0n6n0d6d",                                 // Z
    "4n2n2b4b",                                 // [
    "0n6c",                                     // backslash
    "2n4n4b2b",                                 // ]
    "1j3n5j",                                   // ^
    "0c6c",                                     // _
    "2n4l",                                     // `
    "@0d6d6k0k 6k6d",                           // a
    "0n0d @0d6d6k0k",                           // b
    "~6j6k0k0d6d6e",                            // c
    "6n6d @0d6d6k0k",                           // d
    "0h6h ~6h6k0k0d5d6e",                       // e
    "~5n3n3k 3k3d 1k5k",                        // f
    "@0d6d6k0k 6k6d ~6d6a0a0b",                 // g
    "0n0d ~0h0k6k6h 6h6d",                      // h
    "1k3k3d 1d5d 3n3n",                         // i
    "4k4b ~4b4a1a 4n4n",                        // j
    "0n0d 5k0f 2h6d",                           // k
    "1n3n3d 1d5d",                              // l
    "0k0d ~0i0k3k3i 3i3d ~3i3k6k6i 6i6d",       // m
    "0k0d ~0h0k6k6h 6h6d",                      // n
    "@0d6d6k0k",                                // o
    "0k0a @0d6d6k0k",                           // p
    "6k6a @0d6d6k0k",                           // q
    "1k1d ~1h1k5k6j",                           // r
    "~6j6k0k0h6h6d0d0e",                        // s
    "2n2f ~2f2d5d6e 0k5k",                      // t
    "0k0g ~0g0d6d6g 6k6d",                      // u
    "0k3d6k",                                   // v
    "0k1d3i5d6k",                               // w
    "0d6k 0k6d",                                // x
    "0k3d 6k2a",                                // y
    "0k6k0d6d",                                 // z
    "~5n3n3i1h ~1h3g3b5b",                      // {
    "3n3b",                                     // |
    "~1n3n3i5h ~5h3g3b1b",                      // }
    "~0g0i3i3g6g6i",                            // ~
};

struct Place {
  float x, y;
};

Place mix(Place a, Place b, float t) { return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)}; }

// Chaikin's corner cutting (1974), whose limit is the quadratic B-spline of the polygon.
std::vector<Place> cut_corners(const std::vector<Place>& polygon, bool closed) {
  std::vector<Place> out;
  const std::size_t sides = closed ? polygon.size() : polygon.size() - 1;
  for (std::size_t i = 0; i < sides; ++i) {
    const Place a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    out.push_back(!closed && i == 0 ? a : mix(a, b, 0.25F));
    out.push_back(!closed && i + 1 == sides ? b : mix(a, b, 0.75F));
  }
  return out;
}

void add_stroke(std::string_view text, std::vector<FontSegment>& segments) {
  const char kind = text.front();
  const bool closed = kind == '@';
  if (closed || kind == '~') text.remove_prefix(1);
  std::vector<Place> path;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    path.push_back({static_cast<float>(text[i] - '0'), static_cast<float>(text[i + 1] - 'd')});
  }
  if (closed || kind == '~') {
    for (int round = 0; round < 3; ++round) path = cut_corners(path, closed);
  }
  if (closed) path.push_back(path.front());
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    segments.push_back({path[i].x, path[i].y, path[i + 1].x, path[i + 1].y});
  }
}

std::array<std::vector<FontSegment>, kGlyphCount> cut_all_glyphs() {
  std::array<std::vector<FontSegment>, kGlyphCount> glyphs;
  for (std::size_t g = 0; g < glyphs.size(); ++g) {
    std::string_view rest = kStrokes[g];
    while (!rest.empty()) {
      const std::size_t blank = rest.find(' ');
      add_stroke(rest.substr(0, blank), glyphs[g]);
      rest.remove_prefix(blank == std::string_view::npos ? rest.size() : blank + 1);
    }
  }
  return glyphs;
}

}  // namespace

const std::vector<FontSegment>& glyph_segments(unsigned char character) {
  static const std::array<std::vector<FontSegment>, kGlyphCount> kGlyphs = cut_all_glyphs();
  const bool known = character >= kFirstGlyph && character < kFirstGlyph + kGlyphCount;
  return kGlyphs[static_cast<std::size_t>((known ? character : '?') - kFirstGlyph)];
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
