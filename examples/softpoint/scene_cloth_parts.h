#pragma once

#include <vector>

#include "json_reader.h"
#include "softpoint/cloth/cloth.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A part of a cloth that is as wet as said, in the coordinates of its pattern as placed by the scene (y up).
struct WetPatch {
  Vec3 at = Vec3::Zero();  // m
  double radius = 0;       // m
  double saturation = 0;
};

// All keys of a cloth.
cloth::ClothDesign read_cloth_design(ObjectReader& item);

// The pattern, cut from this fabric: a sheet in the x-z plane that faces +y, or a surface. While describing
// it is empty.
cloth::ClothPattern read_pattern(ObjectReader& item, const cloth::Fabric& fabric);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
