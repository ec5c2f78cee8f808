#include "face_planes.h"

#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>

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
  // The hull rounds its vertices to a grid; the points that were given are exact.
  const auto point = [&](int v) -> const Vec3& {
    return points[static_cast<std::size_t>(hull.original_vertex_index[v])];
  };
  for (int i = 0; i < hull.faces.size(); ++i) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[i]];
    const btConvexHullComputer::Edge* edge = first;
    const Vec3& origin = point(first->getSourceVertex());
    Vec3 normal = Vec3::Zero();  // twice the area (Newell)
    do {
      normal += (point(edge->getSourceVertex()) - origin).cross(point(edge->getTargetVertex()) - origin);
      edge = edge->getNextEdgeOfFace();
    } while (edge != first);
    if (normal.norm() == 0.0) {
      continue;
    }
    normal.normalize();
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : points) {
      offset = std::max(offset, normal.dot(p));
    }
    shape.planes.push_back({normal, offset});
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
