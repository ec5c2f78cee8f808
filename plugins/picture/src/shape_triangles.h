#pragma once

#include "softpoint/core/triangle_mesh.h"

class btCollisionShape;
class btConcaveShape;
class btConvexShape;

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Any convex shape as triangles in its own frame (margin included where the shape itself counts it): exact
// for shapes with vertices, else the hull of its support points in some five hundred directions. May be empty
// for a shape without extent.
TriangleMesh convex_triangles(const btConvexShape& shape);

// Any triangle mesh or height field, equal corners welded.
TriangleMesh concave_triangles(const btConcaveShape& shape);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
