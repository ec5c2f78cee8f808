#include "view.h"

#include <Eigen/Geometry>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(Camera, ProjectsTheTargetToTheMiddle) {
  const Camera camera;
  const Projected at = project(camera, 640, 360, camera.target);
  EXPECT_NEAR(at.x, 320, 1e-9);
  EXPECT_NEAR(at.y, 180, 1e-9);
  EXPECT_NEAR(at.depth, (camera.target - camera.eye).norm(), 1e-12);
}

TEST(Camera, FieldOfViewSpansTheHeight) {
  const Camera camera = front_camera(2, 90);
  EXPECT_NEAR(project(camera, 200, 100, {0, 2, 0}).y, 0, 1e-9);
  EXPECT_NEAR(project(camera, 200, 100, {0, -2, 0}).y, 100, 1e-9);
  EXPECT_NEAR(project(camera, 200, 100, {4, 0, 0}).x, 200, 1e-9);
  EXPECT_LT(project(camera, 200, 100, {0, 0, 3}).depth, 0);
}

TEST(Camera, FrameBoxShowsEveryCorner) {
  const Vec3 low(-1, 0, -3), high(2, 5, 4);
  for (const double aspect : {0.5, 1.0, 16.0 / 9}) {
    const Camera camera = frame_box(low, high, {-1, -0.7, -2}, aspect);
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner((i & 1) ? low.x() : high.x(), (i & 2) ? low.y() : high.y(),
                        (i & 4) ? low.z() : high.z());
      const Projected at = project(camera, static_cast<int>(900 * aspect), 900, corner);
      EXPECT_GT(at.depth, 0);
      EXPECT_TRUE(at.x >= 0 && at.x <= 900 * aspect && at.y >= 0 && at.y <= 900) << corner.transpose();
    }
  }
}

TEST(Camera, IsRefusedByName) {
  const auto refused = [](auto change) {
    Camera camera;
    change(camera);
    return refusal([&] { check(camera); });
  };
  EXPECT_TRUE(mentions(refused([](auto& c) { c.eye.x() = std::nan(""); }), "camera eye"));
  EXPECT_TRUE(mentions(refused([](auto& c) { c.target = c.eye; }), "camera target"));
  EXPECT_TRUE(mentions(refused([](auto& c) { c.up = c.target - c.eye; }), "camera up"));
  EXPECT_TRUE(mentions(refused([](auto& c) { c.up.setZero(); }), "camera up"));
  EXPECT_TRUE(mentions(refused([](auto& c) { c.vertical_fov_degrees = 0.5; }), "vertical_fov_degrees = 0.5"));
  EXPECT_EQ(refused([](auto&) {}), "");
}

TEST(View, ProjectionAgreesWithProject) {
  const Camera camera;
  const View view(camera, 640, 360);
  const Matrix4f matrix = view.projection(0.5, 50);
  for (const Vec3& point : {Vec3(0, 0, 0), Vec3(1, 2, -3), Vec3(-2, 0.5, 1)}) {
    Eigen::Vector4f p;
    p << (point - view.eye).cast<float>(), 1;
    const Eigen::Vector4f clip = matrix * p;
    const Projected at = project(camera, 640, 360, point);
    EXPECT_NEAR(320 * (1 + clip.x() / clip.w()), at.x, 1e-2);
    EXPECT_NEAR(180 * (1 - clip.y() / clip.w()), at.y, 1e-2);
    EXPECT_NEAR(clip.w(), at.depth, 1e-5);
  }
}

TEST(View, TangentsCompleteARightHandedFrame) {
  for (const Vec3& seed : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, -2, 3)}) {
    const Vec3 axis = seed.normalized();
    const auto [first, second] = tangents(axis);
    EXPECT_LT((first.cross(second) - axis).norm(), 1e-12) << axis.transpose();
    EXPECT_NEAR(first.norm(), 1, 1e-12);
  }
}

TEST(View, SeesExactlyTheBoxesThatReachIntoThePyramid) {
  const View view(front_camera(10, 90), 100, 100);
  const auto box = [](const Vec3& center, double half) {
    Box b;
    b.center = center;
    for (int c = 0; c < 3; ++c) b.half[static_cast<std::size_t>(c)] = Vec3::Unit(c) * half;
    return b;
  };
  EXPECT_TRUE(view.sees(box({0, 0, 0}, 1)));
  EXPECT_TRUE(view.sees(box({10.9, 0, 0}, 1)));
  EXPECT_FALSE(view.sees(box({12.1, 0, 0}, 1)));
  EXPECT_FALSE(view.sees(box({0, 0, 11.5}, 1)));
  const Vec3 down(0, -1, 0);
  EXPECT_TRUE(view.sees_shadow(box({0, 40, 0}, 1), down)) << "above: its shadow falls into the picture";
  EXPECT_FALSE(view.sees_shadow(box({0, -40, 0}, 1), down));
  EXPECT_FALSE(view.sees_shadow(box({40, 40, 0}, 1), down));
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
