#pragma once

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Closed surfaces round the origin, triangles counter-clockwise seen from outside, axis along y. Metres.
TriangleMesh unit_box();                          // half extents 1
TriangleMesh unit_sphere(int around, int along);  // radius 1
TriangleMesh unit_cylinder(int around);           // radius 1, y from -1 to 1
TriangleMesh unit_cone(int around);               // base radius 1 at y = -1, tip at y = 1
TriangleMesh capsule(double radius, double half_length, int around, int along);  // without the caps' radius

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
