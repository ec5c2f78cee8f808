#include "shape_triangles.h"

#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConvexHullShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btTriangleCallback.h>
#include <LinearMath/btConvexHullComputer.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "bullet_vec.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

std::vector<btVector3> hull_points(const btConvexShape& shape) {
  std::vector<btVector3> points;
  if (shape.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE) {
    const auto& hull = static_cast<const btConvexHullShape&>(shape);
    for (int i = 0; i < hull.getNumPoints(); ++i) points.push_back(hull.getScaledPoint(i));
  } else if (shape.isPolyhedral()) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    for (int i = 0; i < polyhedron.getNumVertices(); ++i) polyhedron.getVertex(i, points.emplace_back());
  }
  if (!points.empty()) return points;
  constexpr int kDirections = 500;
  for (int i = 0; i < kDirections; ++i) {
    // Points of a sphere along a spiral by the golden angle (Vogel 1979): near even spacing.
    const double y = 1.0 - (2.0 * i + 1.0) / kDirections, r = std::sqrt(1.0 - y * y),
                 angle = 2.3999632297 * i;
    points.push_back(shape.localGetSupportingVertex(btVector3(static_cast<btScalar>(r * std::cos(angle)),
                                                              static_cast<btScalar>(y),
                                                              static_cast<btScalar>(r * std::sin(angle)))));
  }
  return points;
}

// Collects triangles and gives equal corners the same index.
class Welder final : public btTriangleCallback {
 public:
  void processTriangle(btVector3* corners, int /*part*/, int /*index*/) override {
    Triangle triangle{};
    for (std::size_t k = 0; k < 3; ++k) triangle[k] = vertex(to_vec3(corners[k]));
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return;
    mesh_.triangles.push_back(triangle);
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& p) const {
      return std::hash<std::string_view>()({reinterpret_cast<const char*>(p.data()), sizeof p});
    }
  };
  int vertex(const Vec3& p) {
    const std::array<double, 3> key = {p.x() + 0.0, p.y() + 0.0, p.z() + 0.0};  // -0 and 0 are one place
    const auto [found, is_new] = index_.try_emplace(key, mesh_.vertex_count());
    if (is_new) mesh_.vertices.push_back(p);
    return found->second;
  }

  TriangleMesh mesh_;
  std::unordered_map<std::array<double, 3>, int, Hash> index_;
};

}  // namespace

TriangleMesh convex_triangles(const btConvexShape& shape) {
  const std::vector<btVector3> points = hull_points(shape);
  btConvexHullComputer hull;
  hull.compute(&points[0][0], sizeof(btVector3), static_cast<int>(points.size()), 0, 0);
  TriangleMesh mesh;
  for (int i = 0; i < hull.vertices.size(); ++i) mesh.vertices.push_back(to_vec3(hull.vertices[i]));
  for (int f = 0; f < hull.faces.size(); ++f) {
    // The corners of a face, fanned out from the first.
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
    const int apex = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != apex;
         edge = edge->getNextEdgeOfFace()) {
      mesh.triangles.push_back({apex, edge->getSourceVertex(), edge->getTargetVertex()});
    }
  }
  return mesh;
}

TriangleMesh concave_triangles(const btConcaveShape& shape) {
  Welder welder;
  const btVector3 everywhere(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT);
  shape.processAllTriangles(&welder, -everywhere, everywhere);
  return welder.take();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
