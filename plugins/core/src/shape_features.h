#pragma once

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Corners and edges of a shape whose dimensions are set. Rims of cylinders and cones become polygons whose
// sides are no farther than half a millimetre from the circle, where 64 corners suffice for that.
void add_box_features(ColliderShape& shape);
void add_cylinder_features(ColliderShape& shape);
void add_cone_features(ColliderShape& shape);
// Those of the facets: edges between faces that meet at one degree or more, and rims.
void add_facet_features(ColliderShape& shape);
// Facets of a convex polyhedron from its points.
void add_hull_facets(ColliderShape& shape, const std::vector<Vec3>& points);

}  // namespace softpoint::inline SOFTPOINT_ABI
