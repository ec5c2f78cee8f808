#pragma once

#include <string>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A triangle surface. One or several shells; triangles run counter-clockwise seen from
// outside the material (so those of a cavity are seen from within the cavity).
struct TriangleMesh {
  std::vector<Vec3> vertices;       // metres
  std::vector<Triangle> triangles;  // indices into `vertices`

  int vertex_count() const { return static_cast<int>(vertices.size()); }
  int triangle_count() const { return static_cast<int>(triangles.size()); }
};

// What check_closed found out on its way.
struct MeshReport {
  int shells = 0;      // connected pieces of the surface, cavities included
  double volume = 0;   // m^3, cavities subtracted
  double area = 0;     // m^2
};

// Throws Error unless `mesh` bounds a solid: every index valid, every vertex finite and used, no
// degenerate triangle, every edge shared by exactly two triangles that run along it in opposite
// directions, one fan of triangles round every vertex, the outermost shell outward and each cavity
// inward, positive volume. Each refusal names the element (0-based) and what to do about it.
// `name` stands at the head of the message (a file name, "exoskeleton", ...).
MeshReport check_closed(const TriangleMesh& mesh, const std::string& name = "mesh");

// The weaker check for open surfaces (cloth): as above, but edges may have one triangle only.
MeshReport check_surface(const TriangleMesh& mesh, const std::string& name = "mesh");

// Unit normal of a triangle that is not degenerate, and its area in m^2.
Vec3 triangle_normal(const TriangleMesh& mesh, int triangle);
double triangle_area(const TriangleMesh& mesh, int triangle);

// Per vertex, a third of the area of its triangles (m^2).
std::vector<double> vertex_areas(const TriangleMesh& mesh);

// Every edge once, smaller index first, in order of first appearance.
std::vector<std::array<int, 2>> unique_edges(const TriangleMesh& mesh);

}  // namespace softpoint::inline SOFTPOINT_ABI
