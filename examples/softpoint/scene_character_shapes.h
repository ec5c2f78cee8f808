#pragma once

#include <string>
#include <vector>

#include "json_reader.h"
#include "softpoint/elastic/character_shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A shape of segments as a scene names it.
struct NamedShape {
  std::string name;
  elastic::SegmentShape shape;
  std::vector<std::string> patches;  // names of its interfaces after the first two
};

// The list at "shapes": prisms, boxes with patches, meshes from files.
std::vector<NamedShape> read_segment_shapes(ObjectReader& item);

// The index of `name` among `names`; refused at `key` with those there are. 0 while describing.
int find_name(ObjectReader& item, std::string_view key, const std::string& name,
              const std::vector<std::string>& names);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
