#include "light.h"

#include <cmath>

#include "srgb.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

void store(float (&out)[4], const Vec3& v, double w = 0) {
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(v[c]);
  out[3] = static_cast<float>(w);
}

}  // namespace

Vec3 direction_to_light(const RenderSettings& settings, const Vec3& world_up) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  const double azimuth = settings.light_azimuth_degrees * kDegree;
  const double elevation = settings.light_elevation_degrees * kDegree;
  const auto [first, second] = tangents(world_up);
  return (std::sin(elevation) * world_up +
          std::cos(elevation) * (std::cos(azimuth) * first + std::sin(azimuth) * second))
      .normalized();
}

void fill_light(FrameBlock& block, const View& view, const RenderSettings& settings, const Vec3& to_light) {
  store(block.ray_right, view.right * view.tan_x);
  store(block.ray_up, view.up * view.tan_y);
  store(block.ray_forward, view.forward);
  store(block.world_up, view.world_up);
  store(block.to_light, to_light);
  store(block.light_color, {0.98, 0.91, 0.80});
  store(block.sky_zenith, {0.22, 0.40, 0.70});
  store(block.sky_horizon, {0.76, 0.82, 0.88});
  store(block.bounce, {0.19, 0.17, 0.15});
  if (!settings.sky) {
    const Color& color = settings.background;
    const Vec3 plain(decode_srgb(color.r), decode_srgb(color.g), decode_srgb(color.b));
    store(block.sky_horizon, plain);
  }
  const double width = settings.width, height = settings.height;
  block.viewport[0] = static_cast<float>(width);
  block.viewport[1] = static_cast<float>(height);
  block.viewport[2] = static_cast<float>(1 / width);
  block.viewport[3] = static_cast<float>(1 / height);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
