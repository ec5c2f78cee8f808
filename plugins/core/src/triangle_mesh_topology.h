#pragma once

#include <string>
#include <vector>

#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::mesh_check {

// The stages of check_closed and check_surface. Each throws Error; each relies on those before it.

// Indices, finite coordinates, unused vertices, coincident vertices, degenerate triangles.
void check_elements(const TriangleMesh& mesh, const std::string& name);

struct Topology {
  std::vector<int> shell_of;  // per triangle
  int shells = 0;
  int boundary_edges = 0;
};

// Edges shared by one (if `open`) or two triangles of one sense of turning; one fan round each vertex.
Topology check_topology(const TriangleMesh& mesh, const std::string& name, bool open);

// Outer shells outward, cavities inward. Returns the number of outer shells.
int check_shells(const TriangleMesh& mesh, const std::string& name, const Topology& topology);

// "triangle 12 (3, 90, 7)".
std::string triangle_text(const TriangleMesh& mesh, int triangle);

}  // namespace softpoint::inline SOFTPOINT_ABI::mesh_check
