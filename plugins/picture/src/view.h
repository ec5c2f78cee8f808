#pragma once

#include <Eigen/Core>

#include <array>
#include <cmath>

#include "softpoint/picture/camera.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

using Matrix4f = Eigen::Matrix4f;

// An oriented box: all points center + sum of t_i half[i] with |t_i| <= 1.
struct Box {
  Vec3 center{0, 0, 0};
  std::array<Vec3, 3> half{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};

  // Half its thickness along the unit vector `direction`.
  double reach(const Vec3& direction) const {
    return std::abs(half[0].dot(direction)) + std::abs(half[1].dot(direction)) +
           std::abs(half[2].dot(direction));
  }
};

// The camera of one frame. All coordinates handed to the graphics driver are relative to the eye (world
// axes, origin at the eye), so that single precision suffices far from the world's origin.
struct View {
  Vec3 eye{0, 0, 0};
  Vec3 right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};  // of the picture, orthonormal
  Vec3 world_up{0, 1, 0};                               // unit
  double tan_x = 1, tan_y = 1;                          // of half the field of view
  double target_distance = 1;                           // metres
  std::array<Vec3, 4> sides;                            // inward unit normals of the planes through the eye

  View() = default;
  View(const Camera& camera, int width, int height);

  // Does any of `box` (world) lie in front of the camera and within its four side planes? Conservative:
  // never false for a box that shows.
  bool sees(const Box& box) const;
  // Could a shadow thrown by `box` fall where the camera sees it? `travel`: unit direction of the light.
  bool sees_shadow(const Box& box, const Vec3& travel) const;
  // From eye-relative coordinates to clip space, for depths in metres.
  Matrix4f projection(double near_depth, double far_depth) const;
};

// Two unit vectors that complete the unit vector `axis` to a right-handed frame, the same ones every time.
std::array<Vec3, 2> tangents(const Vec3& axis);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
