#pragma once

#include <array>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Whatever lies farther from the origin along an axis is not drawn; cameras are refused there.
inline constexpr double kFarthest = 1e9;  // m

// A pinhole camera in the world frame (right-handed). `up` is the world's up, which also orients sky and
// light; it need not stand at right angles to the line of sight. Near and far planes follow the scene.
struct Camera {
  Vec3 eye{4.0, 3.0, 6.0};             // metres, up to kFarthest from the origin along each axis
  Vec3 target{0.0, 0.5, 0.0};          // metres, likewise
  Vec3 up{0.0, 1.0, 0.0};              // any length from 1e-9 to 1e9
  double vertical_fov_degrees = 40.0;  // 1 to 150
};

// Throws Error for non-finite numbers, a target at the eye, `up` along the line of sight, or a field of
// view outside its range.
SOFTPOINT_API void check(const Camera& camera);

// Where `point` (metres) lands in a picture of that size: pixels from the left and top edge, and the depth
// along the line of sight in metres. A depth <= 0 means behind the eye, x and y then mean nothing.
struct Projected {
  double x = 0;      // pixels from the left
  double y = 0;      // pixels from the top
  double depth = 0;  // metres
};
SOFTPOINT_API Projected project(const Camera& camera, int width, int height, const Vec3& point);

// A camera that looks along `direction` at the middle of a box in the world and shows all of it. Throws Error
// for what check(Camera) refuses, and for an aspect outside 1e-3 to 1e3.
SOFTPOINT_API Camera frame_box(const Vec3& low, const Vec3& high, const Vec3& direction, double aspect,
                               const Vec3& up = {0.0, 1.0, 0.0}, double vertical_fov_degrees = 40.0);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
