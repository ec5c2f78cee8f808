#pragma once

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Generators of surface meshes. Lengths in metres, centre at the origin, triangles outward; all but
// square_grid are closed and pass check_closed. Diagonals alternate with the parity of row + column,
// so that a mesh with even counts has no preferred direction. Every parameter out of range is refused
// with an Error that names it.

// How the radius of a prism is meant.
enum class PrismRadius {
  kCircumscribed,  // vertices lie at the radius
  kEqualArea,      // the cross-section has the area of the circle with that radius (x 1.0130, 16 sides)
};

// A right prism over a regular polygon of `sides`, axis z from -length/2 to length/2, first corner
// at +x. The side has `stacks` layers of quads; each cap has a centre and `cap_rings` rings, the outer
// one being the rim. Vertices: bottom centre; the bottom cap's rings from the inside out, the rim being
// the side's lowest; the side's rings upward; the top cap's inner rings from the outside in; top centre.
// Each ring is counter-clockwise seen from +z and begins at +x.
//   vertices = sides (stacks + 1) + 2 (sides (cap_rings - 1) + 1)
//   (16, 4, 1): 82 vertices, 160 triangles; (16, 8, 2): 178; (24, 12, 3): 410; (32, 16, 4): 738
SOFTPOINT_API TriangleMesh prism(int sides, int stacks, int cap_rings, double radius, double length,
                                 PrismRadius meaning = PrismRadius::kCircumscribed);

// The surface of a box of edge lengths `size`, a grid of nx * ny, ny * nz and nz * nx cells on its faces.
//   vertices = 2 (nx ny + ny nz + nz nx) + 2; cubes of 2, 3, 4, 6, 8 cells: 26, 56, 98, 218, 386
SOFTPOINT_API TriangleMesh box_grid(int nx, int ny, int nz, const Vec3& size);

// An open sheet in the plane z = 0, nx * ny cells, facing +z; vertex (i, j) has index j (nx + 1) + i.
SOFTPOINT_API TriangleMesh square_grid(int nx, int ny, double width, double height);

// A sphere: an icosahedron whose triangles are split in four `subdivisions` times (0 to 8).
//   vertices = 10 * 4^subdivisions + 2: 12, 42, 162, 642, 2562
// The vertices lie on the sphere, so the volume approaches the sphere's from below.
SOFTPOINT_API TriangleMesh sphere(double radius, int subdivisions = 2);

// A sphere of meridians and parallels, poles on the z axis; `rings` parallels between the poles.
SOFTPOINT_API TriangleMesh uv_sphere(double radius, int sectors, int rings);

// A cylinder of `length` along z between two half spheres; whole height length + 2 radius.
// `stacks` layers on the cylinder, `rings` layers on each half sphere.
SOFTPOINT_API TriangleMesh capsule(double radius, double length, int sectors = 16, int stacks = 4,
                                   int rings = 4);

// A sphere with a spherical cavity: two shells, the inner one facing into the cavity.
SOFTPOINT_API TriangleMesh hollow_sphere(double outer_radius, double inner_radius, int subdivisions = 2);

}  // namespace softpoint::inline SOFTPOINT_ABI
