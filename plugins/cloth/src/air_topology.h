#pragma once

#include <span>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// What the search for bubbles knows of a cloth before it moves.
struct AirTopology {
  struct Edge {
    int a, b;         // along the orientation of `face`
    int face, other;  // `other` is -1 on a border
    double length;    // m, at rest
  };
  int points = 0;
  std::vector<Triangle> faces;
  std::vector<Edge> edges;          // in the order of their first face
  std::vector<double> face_areas;   // m2, at rest
  std::vector<double> point_areas;  // m2: a third of the faces round each point
  std::vector<char> closed;         // per face: it belongs to a shell without border
  std::vector<int> shells;          // per face, numbered in the order of their first face
  int shell_count = 0;
};

// `rest`: points of the cloth as cut, m. Throws Error for a face with a bad index and for an edge that has
// more than two faces, or two that run the same way along it.
AirTopology make_air_topology(std::span<const Vec3> rest, std::span<const Triangle> faces);

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
