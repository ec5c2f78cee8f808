#include "hull_features.h"

#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <cmath>
#include <numbers>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

std::vector<Vec3> polyhedron_points(const btPolyhedralConvexShape& shape) {
  std::vector<Vec3> points;
  for (int i = 0; i < shape.getNumVertices(); ++i) {
    btVector3 v;
    shape.getVertex(i, v);
    points.push_back(from_bullet(v));
  }
  return points;
}

// Support points in directions spread evenly over the sphere (a Fibonacci spiral), plus the six axes so
// that flat ends and rims are met.
std::vector<Vec3> sampled_points(const btConvexShape& shape) {
  std::vector<Vec3> points;
  const auto add = [&](const Vec3& direction) {
    points.push_back(from_bullet(shape.localGetSupportingVertex(to_bullet(direction))));
  };
  for (int axis = 0; axis < 3; ++axis) {
    add(Vec3::Unit(axis));
    add(-Vec3::Unit(axis));
  }
  constexpr int kCount = 120;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kCount; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kCount;
    const double r = std::sqrt(1.0 - z * z);
    add({r * std::cos(golden * i), r * std::sin(golden * i), z});
  }
  return points;
}

}  // namespace

void add_hull_features(ColliderShape& shape) {
  const bool polyhedral = shape.convex->isPolyhedral();
  const std::vector<Vec3> points =
      polyhedral ? polyhedron_points(static_cast<const btPolyhedralConvexShape&>(*shape.convex))
                 : sampled_points(*shape.convex);
  shape.feature_radius = polyhedral ? double(shape.convex->getMargin()) : 0.0;
  if (points.size() < 4) {
    shape.corners = points;
    return;
  }
  btConvexHullComputer hull;
  hull.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
  const auto vertex = [&](int i) { return from_bullet(hull.vertices[i]); };
  for (int i = 0; i < hull.vertices.size(); ++i) {
    shape.corners.push_back(vertex(i));
  }
  using Edge = btConvexHullComputer::Edge;
  const auto face_normal = [&](const Edge* edge) {
    const Vec3 a = vertex(edge->getSourceVertex());
    const Vec3 b = vertex(edge->getTargetVertex());
    const Vec3 c = vertex(edge->getNextEdgeOfFace()->getTargetVertex());
    return Vec3((b - a).cross(c - b).normalized());
  };
  for (int i = 0; i < hull.edges.size(); ++i) {
    const Edge* edge = &hull.edges[i];
    if (edge->getSourceVertex() > edge->getTargetVertex()) {
      continue;  // its reverse stands for both
    }
    ShapeEdge feature;
    feature.a = vertex(edge->getSourceVertex());
    feature.b = vertex(edge->getTargetVertex());
    const Vec3 along = (feature.b - feature.a).normalized();
    feature.into_first = face_normal(edge).cross(along);
    feature.into_second = along.cross(face_normal(edge->getReverseEdge()));
    shape.edges.push_back(feature);
  }
  if (polyhedral) {
    for (int i = 0; i < hull.faces.size(); ++i) {
      const Edge* edge = &hull.edges[hull.faces[i]];
      const Vec3 normal = face_normal(edge);
      shape.planes.push_back({normal, normal.dot(vertex(edge->getSourceVertex()))});
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
