#include "softpoint/picture/material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "softpoint/core/error.h"
#include "srgb.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// Ottosson, "A perceptual color space for image processing" (2020): Oklab to linear sRGB.
std::array<double, 3> oklab_to_linear(double lightness, double a, double b) {
  const auto cube = [](double x) { return x * x * x; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

void check(const Material& material, std::string_view name) {
  const Color& color = material.color;
  if (std::isfinite(color.r + color.g + color.b + color.a) && std::isfinite(material.roughness) &&
      std::isfinite(material.wetness)) {
    return;  // without an allocation
  }
  const std::string prefix(name);
  check(color, prefix + " color");
  check_finite(prefix + " roughness", material.roughness);
  check_finite(prefix + " wetness", material.wetness);
}

Color palette_color(int i) {
  check_range("palette_color i", i, 0, std::numeric_limits<int>::max());
  // The golden angle never repeats a hue and keeps every few neighbours far apart; three levels of
  // lightness tell apart what comes close in hue after a while.
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  constexpr double kFirstHue = 40.0, kGoldenAngle = 137.50776;
  constexpr std::array<double, 3> kLightness = {0.69, 0.74, 0.64};
  constexpr double kChroma = 0.125;
  const double hue = std::fmod(kFirstHue + kGoldenAngle * i, 360.0) * kDegree;
  std::array<double, 3> linear{};
  // Paler where a screen cannot show the full chroma.
  for (double chroma = kChroma; chroma > 0; chroma -= 0.005) {
    linear = oklab_to_linear(kLightness[static_cast<std::size_t>(i % 3)], chroma * std::cos(hue),
                             chroma * std::sin(hue));
    if (std::all_of(linear.begin(), linear.end(), [](double c) { return c > 0.01 && c < 0.95; })) break;
  }
  return {static_cast<float>(encode_srgb(linear[0])), static_cast<float>(encode_srgb(linear[1])),
          static_cast<float>(encode_srgb(linear[2]))};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
