#pragma once

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Corners and edges of a shape whose dimensions are set. Rims of cylinders and cones become polygons whose
// sides are no farther than half a millimetre from the circle, where 64 corners suffice for that.
void add_box_features(ColliderShape& shape);
void add_cylinder_features(ColliderShape& shape);
void add_cone_features(ColliderShape& shape);
// Storage that lets features be found again and again without allocating.
struct FeatureWorkspace {
  struct Side {
    int a = 0, b = 0;  // vertices, a < b
    int number = 0;
    Vec3 into = Vec3::Zero();  // from the side into its facet
  };
  std::vector<Vec3> points;
  std::vector<Side> sides;
  std::vector<std::array<int, 2>> ends;
  std::vector<char> sharp;
  std::vector<Bounds> boxes;
};
// Those of the facets: edges between faces that meet at one degree or more, and rims.
void add_facet_features(ColliderShape& shape, FeatureWorkspace& work);
// Facets of a convex polyhedron from its points.
void add_hull_facets(ColliderShape& shape, const std::vector<Vec3>& points);

}  // namespace softpoint::inline SOFTPOINT_ABI
