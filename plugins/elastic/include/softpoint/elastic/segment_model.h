#pragma once

#include <memory>
#include <vector>

#include "softpoint/core/triangle_mesh.h"
#include "softpoint/elastic/boundary_stiffness.h"
#include "softpoint/elastic/material.h"
#include "softpoint/elastic/stiffness_cache.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// How the stiffness behind a segment is made and kept.
struct SegmentSettings {
  StiffnessSettings stiffness;  // accuracy and memory of the assembly
  CacheSettings cache;          // where it is kept between runs
};

// An elastic piece with joining surfaces ("interfaces"), condensed to them: what all segments of one shape
// and material share. Immutable.
//
// Degrees of freedom are axis-major: component a of the i-th of n points is a n + i. Matrices are
// column-major. J joint points are those of all interfaces, one after another; F free vertices are the rest.
struct SegmentModel {
  TriangleMesh mesh;                         // as given
  Material material;                         // as given
  std::vector<std::vector<int>> interfaces;  // as given: vertices of each, the first lying on the bone
  std::vector<int> joint_vertices;           // J: vertices of the mesh
  std::vector<int> free_vertices;            // F
  double volume = 0;                         // m3
  double mass = 0;                           // kg

  std::vector<double> stiffness;        // 3J x 3J, symmetric: joint forces (N) by joint displacements (m)
  std::vector<double> free_response;    // 3F x 3J: free displacements by joint displacements
  std::vector<double> free_compliance;  // 3F x 3F, m/N: free displacements by forces on free vertices
  std::vector<double> joint_weight;     // 3J x 3, m3: load of the joints by a body force (N/m3)
  std::vector<double> free_sag;         // 3F x 3, m4/N: free displacements by a body force, joints held

  int joint_points() const { return static_cast<int>(joint_vertices.size()); }
  int free_points() const { return static_cast<int>(free_vertices.size()); }
};

// Throws Error for a mesh that bounds no solid, a material or setting out of range, no interface, an
// interface of fewer than three vertices or whose vertices lie on a line, an index out of range, or a vertex
// that stands in two interfaces or twice in one.
SOFTPOINT_API std::shared_ptr<const SegmentModel> make_segment_model(
    const TriangleMesh& mesh, const std::vector<std::vector<int>>& interfaces, const Material& material,
    const SegmentSettings& settings = {});

// A prism (softpoint::prism with one cap ring) with both caps as interfaces, lower first, each beginning
// with its centre.
SOFTPOINT_API std::shared_ptr<const SegmentModel> make_prism_segment(int sides, int stacks, double radius,
                                                                     double length, const Material& material,
                                                                     const SegmentSettings& settings = {});

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
