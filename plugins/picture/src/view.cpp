#include "view.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

void check(const Camera& camera) {
  check_range("camera eye", camera.eye, -kFarthest, kFarthest);
  check_range("camera target", camera.target, -kFarthest, kFarthest);
  check_range("camera up", camera.up, -1e9, 1e9);
  check_range("camera vertical_fov_degrees", camera.vertical_fov_degrees, 1.0, 150.0);
  const Vec3 sight = camera.target - camera.eye;
  if (!(sight.norm() > 1e-9)) {
    throw Error("camera target = " + to_text(camera.target) + ": permitted is a point away from the eye");
  }
  if (!(camera.up.norm() >= 1e-9 && sight.normalized().cross(camera.up.normalized()).norm() > 1e-6)) {
    throw Error("camera up = " + to_text(camera.up) +
                ": permitted is a vector of length 1e-9 or more that is not along the line of sight");
  }
}

View::View(const Camera& camera, int width, int height) : eye(camera.eye), world_up(camera.up.normalized()) {
  const Vec3 sight = camera.target - camera.eye;
  target_distance = sight.norm();
  forward = sight / target_distance;
  right = forward.cross(world_up).normalized();
  up = right.cross(forward);
  tan_y = std::tan(camera.vertical_fov_degrees * 3.14159265358979323846 / 360.0);
  tan_x = tan_y * width / height;
  sides = {(forward * tan_x + right).normalized(), (forward * tan_x - right).normalized(),
           (forward * tan_y + up).normalized(), (forward * tan_y - up).normalized()};
}

bool View::sees(const Box& box) const {
  const Vec3 center = box.center - eye;
  if (center.dot(forward) + box.reach(forward) <= 0) return false;
  return std::all_of(sides.begin(), sides.end(),
                     [&](const Vec3& normal) { return center.dot(normal) + box.reach(normal) >= 0; });
}

bool View::sees_shadow(const Box& box, const Vec3& travel) const {
  // The box swept along the light leaves the half-space of a plane only if it starts outside of it and
  // does not move towards it.
  const Vec3 center = box.center - eye;
  return std::all_of(sides.begin(), sides.end(), [&](const Vec3& normal) {
    return travel.dot(normal) > 0 || center.dot(normal) + box.reach(normal) >= 0;
  });
}

Matrix4f View::projection(double near_depth, double far_depth) const {
  Eigen::Matrix4d rotation = Eigen::Matrix4d::Identity();
  rotation.block<1, 3>(0, 0) = right.transpose();
  rotation.block<1, 3>(1, 0) = up.transpose();
  rotation.block<1, 3>(2, 0) = -forward.transpose();
  Eigen::Matrix4d perspective = Eigen::Matrix4d::Zero();
  perspective(0, 0) = 1 / tan_x;
  perspective(1, 1) = 1 / tan_y;
  perspective(2, 2) = -(far_depth + near_depth) / (far_depth - near_depth);
  perspective(2, 3) = -2 * far_depth * near_depth / (far_depth - near_depth);
  perspective(3, 2) = -1;
  return (perspective * rotation).cast<float>();
}

std::array<Vec3, 2> tangents(const Vec3& axis) {
  // The world axis that stands most clearly across comes first, z before x before y, so that a floor of
  // either usual up axis gets tangents along the other two axes.
  const Vec3 across = std::abs(axis.z()) < 0.7 ? Vec3::UnitZ() : Vec3::UnitX();
  const Vec3 second = (across - axis * axis.dot(across)).normalized();
  const Vec3 first = second.cross(axis);
  return {first, second};
}

Projected project(const Camera& camera, int width, int height, const Vec3& point) {
  const View view(camera, width, height);
  const Vec3 p = point - view.eye;
  const double depth = p.dot(view.forward);
  return {0.5 * width * (1 + p.dot(view.right) / (depth * view.tan_x)),
          0.5 * height * (1 - p.dot(view.up) / (depth * view.tan_y)), depth};
}

Camera frame_box(const Vec3& low, const Vec3& high, const Vec3& direction, double aspect, const Vec3& up,
                 double vertical_fov_degrees) {
  check_range("frame_box low", low, -kFarthest, kFarthest);
  check_range("frame_box high", high, -kFarthest, kFarthest);
  check_range("frame_box direction", direction, -kFarthest, kFarthest);
  check_range("frame_box aspect", aspect, 1e-3, 1e3);
  Camera camera;
  camera.target = 0.5 * (low + high);
  camera.up = up;
  camera.vertical_fov_degrees = vertical_fov_degrees;
  camera.eye = camera.target - direction;
  check(camera);
  const double narrower = std::min(1.0, aspect);
  const double half_angle =
      std::atan(std::tan(vertical_fov_degrees * 3.14159265358979323846 / 360.0) * narrower);
  const double radius = std::max(0.5 * (high - low).norm(), 1e-6);
  camera.eye = camera.target - direction.normalized() * (radius / std::sin(half_angle));
  return camera;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
