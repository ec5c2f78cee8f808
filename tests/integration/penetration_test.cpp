#include "metrics_penetration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "player_solid.h"
#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"
#include "support/refusal.h"

namespace softpoint::scene {
namespace {

// A mesh that stands still.
class Statue : public Surface {
 public:
  explicit Statue(TriangleMesh mesh) : mesh_(std::move(mesh)), still_(mesh_.vertices.size(), Vec3::Zero()) {}
  std::span<const Vec3> points() const override { return mesh_.vertices; }
  std::span<const Vec3> velocities() const override { return still_; }
  std::span<const Triangle> faces() const override { return mesh_.triangles; }
  void apply_impulse(int, const Vec3&, const Vec3&) override {}

 private:
  TriangleMesh mesh_;
  std::vector<Vec3> still_;
};

TEST(DepthBelowSkin, OfACubeIsTheDistanceToItsNearestFace) {
  const Statue cube(box_grid(3, 3, 3, Vec3(1.0, 1.0, 1.0)));
  EXPECT_NEAR(depth_below_skin(cube, Vec3(0.1, 0.45, 0.2)), 0.05, 1e-12);
  EXPECT_NEAR(depth_below_skin(cube, Vec3::Zero()), 0.5, 1e-12);
  EXPECT_EQ(depth_below_skin(cube, Vec3(0.1, 0.55, 0.2)), 0.0);
  EXPECT_EQ(depth_below_skin(cube, Vec3(3.0, 0.0, 0.0)), 0.0);
}

TEST(DepthBelowSkin, KnowsThatACavityIsOutside) {
  const Statue shell(hollow_sphere(1.0, 0.5, 2));
  EXPECT_EQ(depth_below_skin(shell, Vec3(0.1, 0.0, 0.0)), 0.0);
  EXPECT_GT(depth_below_skin(shell, Vec3(0.75, 0.0, 0.0)), 0.2);
}

ShapeSpec shape(ShapeKind kind, double radius = 0, double length = 0, int axis = 1) {
  ShapeSpec spec;
  spec.kind = kind;
  spec.radius = radius;
  spec.length = length;
  spec.axis = axis;
  return spec;
}

TEST(ConvexSolid, DepthIsTheDistanceToTheSurfaceFromInside) {
  ShapeSpec box = shape(ShapeKind::kBox);
  box.size = Vec3(2, 4, 6);
  EXPECT_NEAR(ConvexSolid(box).depth(Vec3(0.9, 0, 0)), 0.1, 1e-15);
  EXPECT_LT(ConvexSolid(box).depth(Vec3(0, 2.5, 0)), 0.0);
  EXPECT_NEAR(ConvexSolid(shape(ShapeKind::kSphere, 2)).depth(Vec3(0, 1.5, 0)), 0.5, 1e-15);
  const ConvexSolid capsule(shape(ShapeKind::kCapsule, 1, 2, 0));
  EXPECT_NEAR(capsule.depth(Vec3(0.5, 0.9, 0)), 0.1, 1e-15);
  EXPECT_NEAR(capsule.depth(Vec3(1.9, 0, 0)), 0.1, 1e-15);
  const ConvexSolid cylinder(shape(ShapeKind::kCylinder, 1, 2, 2));
  EXPECT_NEAR(cylinder.depth(Vec3(0, 0.7, 0)), 0.3, 1e-15);
  EXPECT_NEAR(cylinder.depth(Vec3(0, 0, 0.8)), 0.2, 1e-15);
  const ConvexSolid cone(shape(ShapeKind::kCone, 1, 1, 1));  // a slope of 45 degrees
  EXPECT_NEAR(cone.depth(Vec3(0, 0.4, 0)), 0.1 / std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(cone.depth(Vec3(0.2, -0.49, 0)), 0.01, 1e-15);
  ShapeSpec plane = shape(ShapeKind::kPlane);
  plane.offset = 0.25;
  EXPECT_NEAR(ConvexSolid(plane).depth(Vec3(7, 0.2, 7)), 0.05, 1e-15);
}

TEST(ConvexSolid, HullOfABoxIsTheBox) {
  ShapeSpec box = shape(ShapeKind::kBox), hull = shape(ShapeKind::kHull);
  box.size = Vec3(0.2, 0.4, 0.6);
  const Vec3 shift(1.0, 2.0, 3.0);
  const ConvexSolid plain(box);
  for (const Vec3& corner : plain.corners()) {
    hull.points.push_back(corner + shift);
  }
  hull.points.push_back(shift);  // inside: no corner
  const ConvexSolid solid(hull);
  EXPECT_EQ(solid.corners().size(), 8u);
  EXPECT_NEAR(solid.volume(), 0.048, 1e-15);
  EXPECT_LT((solid.center() - shift).norm(), 1e-14);
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.09, 0.1, 0.1), Vec3(0, 0.3, 0)}) {
    EXPECT_NEAR(solid.depth(shift + p), plain.depth(p), 1e-14);
  }
}

TEST(ConvexSolid, RefusesAFlatHull) {
  ShapeSpec hull = shape(ShapeKind::kHull);
  hull.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  expect_refusal([&] { ConvexSolid{hull}; }, {"no volume"});
}

}  // namespace
}  // namespace softpoint::scene
