#pragma once

#include "collider_shape.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Corners, edges and (for polyhedra) face planes of a convex shape. Polyhedra give their own vertices
// with the collision margin as feature radius; round shapes are sampled by their support function.
void add_hull_features(ColliderShape& shape);

}  // namespace softpoint::inline SOFTPOINT_ABI
