// Distances of rigid shapes against brute force, and the features of hulls against their definition.
#include "collider_shape.h"

#include "mesh_patches.h"

#include <btBulletCollisionCommon.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <numbers>

#include "support/penetration.h"
#include "support/precision.h"

namespace softpoint {
namespace {

class Noise {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-52 - 1.0;
  }
  Vec3 vector() {
    const double x = (*this)(), y = (*this)(), z = (*this)();
    return {x, y, z};
  }

 private:
  std::uint64_t state_ = 99;
};

btTransform identity() { return btTransform::getIdentity(); }

// Distance by `brute_distance`, normal by its differences.
void expect_distances(const btCollisionShape& shape, double size, double tolerance,
                      bool only_inside_or_near = false) {
  ColliderShapes shapes;
  const ColliderShape& collider = shapes.get(shape);
  Noise noise;
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = 1.6 * size * noise.vector();
    const double expected = brute_distance(shape, identity(), p);
    if (only_inside_or_near && expected > 0) continue;
    const SurfaceDistance found = collider.distance(p);
    ASSERT_NEAR(found.distance, expected, tolerance) << "at " << p.transpose();
    ASSERT_NEAR(found.normal.norm(), 1.0, by_precision(1e-9, 1e-5));
    // Stepping along the normal changes the distance one to one, wherever it is smooth.
    const double h = 1e-6 * size, ahead = brute_distance(shape, identity(), p + h * found.normal);
    const double behind = brute_distance(shape, identity(), p - h * found.normal);
    // (Not for round convex shapes in single precision: EPA gives no normal worth a derivative.)
    if (std::abs(ahead + behind - 2 * expected) < 1e-3 * h && collider.kind != ColliderShape::Kind::round) {
      ASSERT_NEAR((ahead - behind) / (2 * h), 1.0, by_precision(1e-3, 2e-2)) << "at " << p.transpose();
    }
    if (!collider.beyond(p, 0.0)) ++near;
    if (collider.beyond(p, 0.05)) {
      ASSERT_GT(expected, 0.05 - tolerance) << "at " << p.transpose();
    }
  }
  EXPECT_GT(near, 20);
}

constexpr double kClosedForm = by_precision(1e-12, 1e-6);

TEST(ColliderShape, Plane) {
  const btStaticPlaneShape plane(btVector3(1, 2, -1).normalized(), btScalar(0.3));
  expect_distances(plane, 1.0, by_precision(1e-12, 1e-6));
}
TEST(ColliderShape, Box) {
  expect_distances(btBoxShape(btVector3(btScalar(0.5), btScalar(0.2), btScalar(1))), 1.0, kClosedForm);
}
TEST(ColliderShape, Sphere) { expect_distances(btSphereShape(btScalar(0.7)), 0.7, kClosedForm); }
TEST(ColliderShape, Capsules) {
  expect_distances(btCapsuleShape(btScalar(0.3), btScalar(1)), 0.8, kClosedForm);
  expect_distances(btCapsuleShapeX(btScalar(0.3), btScalar(1)), 0.8, kClosedForm);
  expect_distances(btCapsuleShapeZ(btScalar(0.2), btScalar(0.5)), 0.5, kClosedForm);
}
TEST(ColliderShape, Cylinders) {
  expect_distances(btCylinderShape(btVector3(btScalar(0.4), btScalar(0.5), btScalar(0.4))), 0.6, kClosedForm);
  expect_distances(btCylinderShapeX(btVector3(btScalar(0.5), btScalar(0.2), btScalar(0.2))), 0.5,
                   kClosedForm);
  expect_distances(btCylinderShapeZ(btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.1))), 0.5,
                   kClosedForm);
}
TEST(ColliderShape, Cones) {
  expect_distances(btConeShape(btScalar(0.4), btScalar(0.7)), 0.6, kClosedForm);
  expect_distances(btConeShapeX(btScalar(0.2), btScalar(0.9)), 0.6, kClosedForm);
  expect_distances(btConeShapeZ(btScalar(0.5), btScalar(0.3)), 0.5, kClosedForm);
}
TEST(ColliderShape, ScaledShapesFollowTheirScale) {
  btBoxShape box(btVector3(1, 1, 1));
  ColliderShapes shapes;
  EXPECT_NEAR(shapes.get(box).distance(Vec3(3, 0, 0)).distance, 2.0, 1e-6);
  box.setLocalScaling(btVector3(btScalar(0.5), 1, 1));
  EXPECT_NEAR(shapes.get(box).distance(Vec3(3, 0, 0)).distance, 2.5, 1e-6);
}

btConvexHullShape cube_hull(double half, int per_edge) {
  btConvexHullShape hull;
  for (int i = 0; i <= per_edge; ++i) {
    for (int j = 0; j <= per_edge; ++j) {
      for (int k = 0; k <= per_edge; ++k) {
        const double step = 2 * half / per_edge;
        hull.addPoint(
            btVector3(btScalar(-half + i * step), btScalar(-half + j * step), btScalar(-half + k * step)),
            false);
      }
    }
  }
  hull.recalcLocalAabb();
  return hull;
}

btConvexHullShape random_hull(int points, std::uint64_t seed) {
  Noise noise;
  for (std::uint64_t i = 0; i < seed * 7; ++i) noise();
  btConvexHullShape hull;
  for (int i = 0; i < points; ++i) {
    const Vec3 p = 0.4 * noise.vector();
    hull.addPoint(btVector3(btScalar(p.x()), btScalar(p.y()), btScalar(p.z())), false);
  }
  hull.recalcLocalAabb();
  return hull;
}

TEST(ColliderShape, HullIsExact) {
  for (const int seed : {0, 1, 2}) {
    const btConvexHullShape hull = random_hull(12, static_cast<std::uint64_t>(seed));
    expect_distances(hull, 0.45, by_precision(1e-6, 1e-4));
  }
}

TEST(ColliderShape, HullOutsideAgreesWithItsFaces) {
  // A hull in the shape of a cube has the distance of a cube.
  const btConvexHullShape hull = cube_hull(0.5, 1);
  ColliderShapes shapes;
  const ColliderShape& collider = shapes.get(hull);
  Noise noise;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = 1.2 * noise.vector();
    const Vec3 over = p.cwiseAbs() - Vec3::Constant(0.5);
    const double expected = over.cwiseMax(0.0).norm() + std::min(over.maxCoeff(), 0.0);
    ASSERT_NEAR(collider.distance(p).distance, expected, by_precision(1e-6, 2e-4)) << p.transpose();
  }
}

// Every point of the hull lies behind every plane; every plane touches three of them at least.
void expect_valid_planes(const btConvexHullShape& hull, double size) {
  ColliderShapes shapes;
  const ColliderShape& s = shapes.get(hull);
  const double tolerance = by_precision(1e-6, 1e-5) * size;
  ASSERT_GE(s.facets.size(), 4u);
  for (const ShapeFacet& plane : s.facets) {
    EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-5);
    int on = 0;
    for (int i = 0; i < hull.getNumPoints(); ++i) {
      const btVector3 p = hull.getScaledPoint(i);
      const double d = plane.normal.dot(Vec3(p.x(), p.y(), p.z())) - plane.offset;
      EXPECT_LE(d, tolerance);
      on += d > -tolerance;
    }
    EXPECT_GE(on, 3);
  }
}

TEST(HullPlanes, OfManyHullsAreValid) {
  expect_valid_planes(cube_hull(0.5, 1), 0.5);
  expect_valid_planes(cube_hull(0.5, 3), 0.5);  // coplanar points on every face, collinear ones on every edge
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    expect_valid_planes(random_hull(5 + static_cast<int>(seed) * 3, seed), 0.4);
  }
  btConvexHullShape prism;
  for (int i = 0; i < 24; ++i) {
    for (const double y : {-0.3, 0.3}) {
      const double angle = i * std::numbers::pi / 12.0;
      prism.addPoint(btVector3(btScalar(0.4 * std::cos(angle)), btScalar(y), btScalar(0.4 * std::sin(angle))),
                     false);
    }
  }
  prism.recalcLocalAabb();
  expect_valid_planes(prism, 0.4);
}

TEST(HullPlanes, OfACubeAreSix) {
  for (const int per_edge : {1, 3}) {
    ColliderShapes shapes;
    EXPECT_GE(shapes.get(cube_hull(0.5, per_edge)).facets.size(), 12u) << per_edge;
  }
}

// Nearest distance of core and triangle by sampling the triangle.
void expect_core_distances(const btConvexShape& shape, double size, double tolerance) {
  ColliderShapes shapes;
  const ColliderShape& s = shapes.get(shape);
  ASSERT_TRUE(s.meets_faces());
  Noise noise;
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 middle = 2.0 * size * noise.vector();
    const Vec3 a = middle + 0.4 * size * noise.vector(), b = middle + 0.4 * size * noise.vector();
    const Vec3 c = middle + 0.4 * size * noise.vector();
    if ((b - a).cross(c - a).norm() < 0.01 * size * size) continue;
    double nearest = std::numeric_limits<double>::infinity();
    constexpr int kGrid = 60;
    for (int u = 0; u <= kGrid; ++u) {
      for (int v = 0; u + v <= kGrid; ++v) {
        const Vec3 p = a + (b - a) * u / kGrid + (c - a) * v / kGrid;
        nearest = std::min(nearest, s.distance(p).distance);
      }
    }
    ColliderShape::CoreDistance line;
    if (!s.core_distance(a, b, c, line)) {
      EXPECT_LT(nearest, 0.02 * size - s.core_radius()) << "said to overlap";
      continue;
    }
    ++found;
    EXPECT_NEAR((line.on_triangle - line.on_core).norm(), line.distance, tolerance);
    EXPECT_LT(line.distance - s.core_radius(), nearest + tolerance);
    EXPECT_GT(line.distance - s.core_radius(), nearest - 0.02 * size - tolerance);  // the grid is coarse
    EXPECT_NEAR(distance_to_triangle(line.on_triangle, a, b, c), 0.0, tolerance);
    if (s.kind != ColliderShape::Kind::round) {  // EPA is no measure for depths
      EXPECT_NEAR(s.distance(line.on_core).distance, -s.core_radius(), 2 * tolerance);
    }
  }
  EXPECT_GT(found, 50);
}

TEST(CoreDistance, MatchesSampling) {
  expect_core_distances(btSphereShape(btScalar(0.5)), 0.5, by_precision(1e-9, 1e-5));
  expect_core_distances(btCapsuleShape(btScalar(0.2), btScalar(0.6)), 0.5, by_precision(1e-6, 1e-5));
  expect_core_distances(btCapsuleShapeX(btScalar(0.2), btScalar(0.6)), 0.5, by_precision(1e-6, 1e-5));
  const btVector3 centers[] = {btVector3(btScalar(-0.1), 0, 0), btVector3(btScalar(0.1), btScalar(0.1), 0)};
  const btScalar radii[] = {btScalar(0.3), btScalar(0.2)};
  expect_core_distances(btMultiSphereShape(centers, radii, 2), 0.5, by_precision(1e-3, 2e-3));
}

TEST(BoxFeatures, AreItsOwn) {
  ColliderShapes shapes;
  const btBoxShape box(btVector3(1, 2, 3));
  const ColliderShape& s = shapes.get(box);
  ASSERT_EQ(s.corners.size(), 8u);
  ASSERT_EQ(s.edges.size(), 12u);
  for (const ShapeEdge& edge : s.edges) {
    const Vec3 middle = 0.5 * (edge.a + edge.b);
    for (const Vec3& into : {edge.into_first, edge.into_second}) {
      EXPECT_NEAR(s.distance(middle + 0.5 * into).distance, 0.0, 1e-6);  // along the face
    }
    EXPECT_LT(s.distance(middle + 0.1 * (edge.into_first + edge.into_second)).distance, 0.0);
  }
}

// Another shape at a remembered address is another shape, whatever its bounds.
TEST(ColliderShapes, ForgetAShapeThatWasReplacedInPlace) {
  alignas(16) unsigned char memory[sizeof(btConvexHullShape)];
  ColliderShapes shapes;
  const auto wedge = [&](double lean) {
    auto* hull = new (memory) btConvexHullShape;
    for (const double z : {-0.5, 0.5}) {
      hull->addPoint(btVector3(btScalar(-0.5), btScalar(-0.5), btScalar(z)), false);
      hull->addPoint(btVector3(btScalar(0.5), btScalar(-0.5), btScalar(z)), false);
      hull->addPoint(btVector3(btScalar(0.5 * lean), btScalar(0.5), btScalar(z)), false);
    }
    hull->recalcLocalAabb();
    return hull;
  };
  const Vec3 probe(-0.4, 0.2, 0);  // inside the wedge that leans left, outside of the other
  btConvexHullShape* left = wedge(-1);
  const double inside = shapes.get(*left).distance(probe).distance;
  left->~btConvexHullShape();
  btConvexHullShape* right = wedge(1);
  const double outside = shapes.get(*right).distance(probe).distance;
  EXPECT_LT(inside, -0.05);
  EXPECT_GT(outside, 0.1);
  const auto deepest = [&](const ColliderShape& s) {
    double d = -1;
    for (const ShapeFacet& plane : s.facets) d = std::max(d, plane.normal.dot(probe) - plane.offset);
    return d;
  };
  EXPECT_GT(deepest(shapes.get(*right)), 0.1) << "planes of the shape that is gone";
  right->~btConvexHullShape();
}

// Every corner of a shape is on its surface and foremost in the direction away from its edges; every edge
// runs along the surface and its two directions lead along the faces.
void expect_features_on_surface(const btCollisionShape& shape, std::size_t corners, std::size_t edges) {
  ColliderShapes shapes;
  const ColliderShape& s = shapes.get(shape);
  EXPECT_EQ(s.corners.size(), corners);
  EXPECT_EQ(s.edges.size(), edges);
  ASSERT_EQ(s.corner_edges_from.size(), s.corners.size() + 1);
  constexpr double kRim = 6e-4;  // a polygon stands for a circle
  for (std::size_t i = 0; i < s.corners.size(); ++i) {
    EXPECT_NEAR(s.distance(s.corners[i]).distance, 0.0, by_precision(1e-9, 1e-6));
    const std::span<const Vec3> directions = s.edges_of_corner(static_cast<int>(i));
    EXPECT_GE(directions.size(), 3u);
    for (const Vec3& edge : directions) {
      EXPECT_NEAR(edge.norm(), 1.0, 1e-6);
      EXPECT_LT(s.distance(s.corners[i] + 1e-3 * edge).distance, 1e-5) << "an edge leads away from the shape";
    }
  }
  for (const ShapeEdge& edge : s.edges) {
    for (const double t : {0.1, 0.5, 0.9}) {
      const Vec3 p = (1 - t) * edge.a + t * edge.b;
      EXPECT_NEAR(s.distance(p).distance, 0.0, kRim);
      for (const Vec3& into : {edge.into_first, edge.into_second}) {
        EXPECT_NEAR(into.norm(), 1.0, 1e-6);
        EXPECT_NEAR(into.dot((edge.b - edge.a).normalized()), 0.0, 1e-6);
        EXPECT_NEAR(s.distance(p + 5e-3 * into).distance, 0.0, 2 * kRim);
      }
    }
  }
}

TEST(Features, LieOnTheSurface) {
  expect_features_on_surface(btBoxShape(btVector3(btScalar(0.3), btScalar(0.2), btScalar(0.4))), 8, 12);
  expect_features_on_surface(btCylinderShape(btVector3(btScalar(0.2), btScalar(0.1), btScalar(0.2))), 2 * 45,
                             3 * 45);
  expect_features_on_surface(btConeShapeZ(btScalar(0.2), btScalar(0.5)), 46, 90);
  expect_features_on_surface(cube_hull(0.5, 1), 8, 12);
}

// Points in the middle of a hull's faces and edges are no corners.
TEST(Features, FlatNeighboursMakeNone) {
  ColliderShapes shapes;
  const ColliderShape& s = shapes.get(cube_hull(0.5, 3));
  double length = 0;
  for (const ShapeEdge& edge : s.edges) length += (edge.b - edge.a).norm();
  EXPECT_NEAR(length, 12.0, by_precision(1e-6, 1e-4));
}

TEST(Meshes, AreTakenPatchByPatch) {
  btTriangleMesh triangles;
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      const auto at = [](int u, int v) {
        return btVector3(btScalar(0.1 * u), btScalar(u % 2 ? 0.05 : 0), btScalar(0.1 * v));
      };
      triangles.addTriangle(at(i, j), at(i, j + 1), at(i + 1, j));
      triangles.addTriangle(at(i + 1, j), at(i, j + 1), at(i + 1, j + 1));
    }
  }
  btBvhTriangleMeshShape mesh(&triangles, true);
  EXPECT_TRUE(is_mesh(mesh));
  EXPECT_FALSE(is_mesh(btStaticPlaneShape(btVector3(0, 1, 0), 0)));
  EXPECT_FALSE(is_mesh(btBoxShape(btVector3(1, 1, 1))));
  btCollisionObject object;
  MeshPatches patches;
  bool fresh = false;
  const Bounds region{Vec3(1.8, -0.5, 1.8), Vec3(2.2, 0.5, 2.2)};
  const ColliderShape& patch = patches.get(0, object, 0, mesh, region, fresh);
  EXPECT_TRUE(fresh);
  EXPECT_EQ(patch.kind, ColliderShape::Kind::mesh);
  EXPECT_GT(patch.facets.size(), 4u * 4 * 2);
  EXPECT_LT(patch.facets.size(), 14u * 14 * 2);
  int ridges = 0;
  for (const ShapeEdge& edge : patch.edges) {
    const Vec3 middle = 0.5 * (edge.a + edge.b);
    if (!Bounds::of(middle).misses(region)) {
      EXPECT_NEAR(std::abs((edge.b - edge.a).normalized().z()), 1.0, 1e-6) << "diagonals lie in a flat face";
      EXPECT_NE(edge.into_second, Vec3(Vec3::Zero())) << "no rim in the middle of a mesh";
      ++ridges;
    }
  }
  EXPECT_GT(ridges, 8);
  // A little farther is still in the patch; far away is not.
  patches.begin_substep();
  const Bounds near{region.low.array() + 0.05, region.high.array() + 0.05};
  patches.get(0, object, 0, mesh, near, fresh);
  EXPECT_FALSE(fresh);
  patches.get(0, object, 0, mesh, {Vec3(0.2, -0.5, 0.2), Vec3(0.6, 0.5, 0.6)}, fresh);
  EXPECT_TRUE(fresh);
  // Scaled in place, it is another mesh.
  mesh.setLocalScaling(btVector3(2, 1, 1));
  patches.get(0, object, 0, mesh, {Vec3(0.2, -0.5, 0.2), Vec3(0.6, 0.5, 0.6)}, fresh);
  EXPECT_TRUE(fresh);
}

TEST(ColliderShape, UnknownShapesAreNotSupportedAndSaySo) {
  btEmptyShape shape;
  ColliderShapes shapes;
  EXPECT_EQ(shapes.get(shape).kind, ColliderShape::Kind::unsupported);
  EXPECT_TRUE(std::isinf(shapes.get(shape).distance(Vec3::Zero()).distance));
}

}  // namespace
}  // namespace softpoint
