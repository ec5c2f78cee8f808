#pragma once

#include <vector>

#include "placed_design.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Vertices and triangles of a design's skin. Vertices of joining surfaces are shared; those inside, which
// nothing seen uses, come last.
struct SkinLayout {
  std::vector<std::vector<int>> point_of;  // of each placed segment, its vertices' indices in the skin
  std::vector<int> first_free;             // of each placed segment: its free vertices follow in their order
  std::vector<Vec3> rest;                  // m
  std::vector<Triangle> faces;             // seen from outside
  int visible = 0;                         // the first so many are
};

SkinLayout lay_out_skin(const PlacedDesign& placed);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
