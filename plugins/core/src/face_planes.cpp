#include "face_planes.h"

#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <LinearMath/btConvexHullComputer.h>

namespace softpoint::inline SOFTPOINT_ABI {

void add_face_planes(ColliderShape& shape) {
  if (!shape.convex->isPolyhedral()) {
    return;
  }
  const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(*shape.convex);
  std::vector<Vec3> points;
  for (int i = 0; i < polyhedron.getNumVertices(); ++i) {
    btVector3 v;
    polyhedron.getVertex(i, v);
    points.push_back(from_bullet(v));
  }
  if (points.size() < 4) {
    return;  // flat: it has no inside
  }
  btConvexHullComputer hull;
  hull.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
  for (int i = 0; i < hull.faces.size(); ++i) {
    const btConvexHullComputer::Edge* edge = &hull.edges[hull.faces[i]];
    const Vec3 a = from_bullet(hull.vertices[edge->getSourceVertex()]);
    const Vec3 b = from_bullet(hull.vertices[edge->getTargetVertex()]);
    const Vec3 c = from_bullet(hull.vertices[edge->getNextEdgeOfFace()->getTargetVertex()]);
    const Vec3 normal = (b - a).cross(c - b).normalized();
    shape.planes.push_back({normal, normal.dot(a)});
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
