#include "softpoint/picture/image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
}

// The source pixels under one target pixel, with the share of each that it covers.
struct Span {
  int first = 0, last = 0;  // inclusive
  double first_weight = 0, last_weight = 0;
  double weight(int i) const { return i == first ? first_weight : i == last ? last_weight : 1.0; }
};

Span covered(int target, int target_count, int source_count) {
  const double ratio = static_cast<double>(source_count) / target_count;
  const double begin = target * ratio, end = std::min<double>((target + 1) * ratio, source_count);
  Span span;
  span.first = static_cast<int>(begin);
  span.last = std::max(span.first, static_cast<int>(std::ceil(end)) - 1);
  span.last = std::min(span.last, source_count - 1);
  span.first_weight = std::min(end, span.first + 1.0) - begin;
  span.last_weight = end - span.last;
  return span;
}

}  // namespace

void check(const Color& color, std::string_view name) {
  if (std::isfinite(color.r) && std::isfinite(color.g) && std::isfinite(color.b) && std::isfinite(color.a)) {
    return;  // without an allocation
  }
  const std::string prefix(name);
  check_finite(prefix + " r", color.r);
  check_finite(prefix + " g", color.g);
  check_finite(prefix + " b", color.b);
  check_finite(prefix + " a", color.a);
}

Image::Image(int width_, int height_, Color fill) : width(width_), height(height_) {
  check_range("image width", width, 1, 1 << 16);
  check_range("image height", height, 1, 1 << 16);
  check(fill, "image fill");
  const std::uint8_t bytes[4] = {to_byte(fill.r), to_byte(fill.g), to_byte(fill.b), to_byte(fill.a)};
  rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (std::size_t i = 0; i < rgba.size(); ++i) rgba[i] = bytes[i % 4];
}

Image shrink(const Image& image, int width, int height) {
  check_range("shrink width", width, 1, image.width);
  check_range("shrink height", height, 1, image.height);
  Image out(width, height);
  for (int y = 0; y < height; ++y) {
    const Span rows = covered(y, height, image.height);
    for (int x = 0; x < width; ++x) {
      const Span columns = covered(x, width, image.width);
      double sum[4] = {}, total = 0;
      for (int sy = rows.first; sy <= rows.last; ++sy) {
        for (int sx = columns.first; sx <= columns.last; ++sx) {
          const double weight = rows.weight(sy) * columns.weight(sx);
          const std::uint8_t* source = image.pixel(sx, sy);
          for (int c = 0; c < 4; ++c) sum[c] += weight * source[c];
          total += weight;
        }
      }
      std::uint8_t* target = out.pixel(x, y);
      for (int c = 0; c < 4; ++c) target[c] = static_cast<std::uint8_t>(std::lround(sum[c] / total));
    }
  }
  return out;
}

double psnr(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height) {
    throw Error("psnr: picture sizes " + std::to_string(a.width) + "x" + std::to_string(a.height) + " and " +
                std::to_string(b.width) + "x" + std::to_string(b.height) + ": permitted are equal sizes");
  }
  double squares = 0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) {
    if (i % 4 == 3) continue;  // opacity
    const double difference = static_cast<double>(a.rgba[i]) - b.rgba[i];
    squares += difference * difference;
  }
  if (squares == 0) return std::numeric_limits<double>::infinity();
  const double mean = squares / (0.75 * static_cast<double>(a.rgba.size()));
  return 10.0 * std::log10(255.0 * 255.0 / mean);
}

std::uint64_t hash(const Image& image) {
  std::uint64_t value = 14695981039346656037ULL;
  const auto take = [&value](std::uint8_t byte) { value = (value ^ byte) * 1099511628211ULL; };
  for (const int size : {image.width, image.height}) {
    for (int shift = 0; shift < 32; shift += 8) take(static_cast<std::uint8_t>(size >> shift));
  }
  for (const std::uint8_t byte : image.rgba) take(byte);
  return value;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
