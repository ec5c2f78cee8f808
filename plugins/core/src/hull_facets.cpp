#include "shape_features.h"

#include <LinearMath/btConvexHullComputer.h>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {

namespace {

// What the grid of the hull calls one face may be several, folded along one diagonal or another: the fan is
// right whose triangles all points lie behind.
void add_face(ColliderShape& shape, const std::vector<Vec3>& points, const std::vector<Vec3>& loop,
              double size) {
  const std::size_t before = shape.facets.size();
  for (std::size_t a = 0; a < loop.size(); ++a) {
    bool whole = true;
    for (std::size_t b = 1; b + 1 < loop.size(); ++b) {
      ShapeFacet facet;
      facet.a = loop[a];
      facet.b = loop[(a + b) % loop.size()];
      facet.c = loop[(a + b + 1) % loop.size()];
      facet.normal = (facet.b - facet.a).cross(facet.c - facet.a).normalized();
      facet.offset = facet.normal.dot(facet.a);
      const bool behind =
          facet.normal.norm() > 0.5 && std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
            return facet.normal.dot(p) <= facet.offset + 1e-6 * size;
          });
      whole &= behind;
      if (behind) {
        shape.facets.push_back(facet);
      }
    }
    if (whole) {  // this fan alone covers the face
      shape.facets.erase(shape.facets.begin() + static_cast<std::ptrdiff_t>(before),
                         shape.facets.end() - static_cast<std::ptrdiff_t>(loop.size() - 2));
      return;
    }
  }
}

}  // namespace

void add_hull_facets(ColliderShape& shape, const std::vector<Vec3>& points) {
  if (points.size() < 4) {
    return;  // flat: it has no inside
  }
  btConvexHullComputer hull;
  hull.compute(points.front().data(), sizeof(Vec3), static_cast<int>(points.size()), 0, 0);
  // The hull rounds its vertices to a grid; the points that were given are exact.
  const auto point = [&](int v) -> const Vec3& {
    return points[static_cast<std::size_t>(hull.original_vertex_index[v])];
  };
  double size = 0.0;
  for (const Vec3& p : points) {
    size = std::max(size, p.norm());
  }
  std::vector<Vec3> loop;
  for (int i = 0; i < hull.faces.size(); ++i) {
    const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[i]];
    const btConvexHullComputer::Edge* edge = first;
    loop.clear();
    do {
      loop.push_back(point(edge->getSourceVertex()));
      edge = edge->getNextEdgeOfFace();
    } while (edge != first);
    add_face(shape, points, loop, size);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
