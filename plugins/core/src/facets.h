#pragma once

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The faces of a convex polyhedron, without its margin; none for round shapes.
void add_facets(ColliderShape& shape);

}  // namespace softpoint::inline SOFTPOINT_ABI
