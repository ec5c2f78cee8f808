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

  // Number of vertices.
  int vertex_count() const { return static_cast<int>(vertices.size()); }
  // Number of triangles.
  int triangle_count() const { return static_cast<int>(triangles.size()); }
};

// What the checks found out on their way.
struct MeshReport {
  int shells = 0;          // connected pieces of the surface, cavities included
  int bodies = 0;          // shells that bound material from outside; 0 for an open surface
  int boundary_edges = 0;  // edges with one triangle; 0 for a closed mesh
  double volume = 0;       // m^3, cavities subtracted; 0 for an open surface
  double area = 0;         // m^2
};

// A triangle whose height over its longest edge is below this fraction of that edge is degenerate.
inline constexpr double kMinTriangleHeight = 1e-6;
// Vertices nearer to each other than this fraction of the mesh's bounding-box diagonal coincide.
inline constexpr double kMinVertexDistance = 1e-9;

// Throws Error unless `mesh` bounds a solid: every index valid, every vertex finite and used, no two
// vertices in one place, no degenerate triangle, every edge shared by exactly two triangles that run
// along it in opposite directions, one fan of triangles round every vertex, each outer shell outward
// and each cavity inward (by signed volume, and by winding number for which shell lies in which).
// Each refusal names the element (0-based) and what to do about it. `name` stands at the head of the
// message (a file name, "exoskeleton", ...). Whether the surface passes through itself is not checked.
// Cost: O(n log n), and O(shells * n) for shells whose bounding boxes nest.
SOFTPOINT_API MeshReport check_closed(const TriangleMesh& mesh, const std::string& name = "mesh");

// The weaker check for open surfaces (cloth): as above, but edges may have one triangle only, and
// nothing is asked of shells.
SOFTPOINT_API MeshReport check_surface(const TriangleMesh& mesh, const std::string& name = "mesh");

// Unit normal of a triangle that is not degenerate, and its area in m^2.
SOFTPOINT_API Vec3 triangle_normal(const TriangleMesh& mesh, int triangle);
SOFTPOINT_API double triangle_area(const TriangleMesh& mesh, int triangle);

// Per vertex, a third of the area of its triangles (m^2).
SOFTPOINT_API std::vector<double> vertex_areas(const TriangleMesh& mesh);

// Every edge once, smaller index first, in order of first appearance.
SOFTPOINT_API std::vector<std::array<int, 2>> unique_edges(const TriangleMesh& mesh);

// The volume inside (m^3; negative for a surface that is inside out) and the area (m^2).
SOFTPOINT_API double signed_volume(const TriangleMesh& mesh);
SOFTPOINT_API double surface_area(const TriangleMesh& mesh);

// x -> linear * x + offset on every vertex; triangles are turned over if `linear` mirrors.
SOFTPOINT_API TriangleMesh transformed(const TriangleMesh& mesh, const Mat3& linear, const Vec3& offset);
// Every triangle turned over.
SOFTPOINT_API TriangleMesh flipped(const TriangleMesh& mesh);
// Both meshes in one, `b` after `a`; nothing is welded.
SOFTPOINT_API TriangleMesh merged(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace softpoint::inline SOFTPOINT_ABI
