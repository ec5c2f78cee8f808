#pragma once

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Face planes of a convex polyhedron, without its margin; none for round shapes.
void add_face_planes(ColliderShape& shape);

}  // namespace softpoint::inline SOFTPOINT_ABI
