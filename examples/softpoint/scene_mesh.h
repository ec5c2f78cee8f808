#pragma once

#include <string_view>

#include "json_reader.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The object at `key`: a closed surface from a generator, or from an OBJ file.
TriangleMesh read_mesh(ObjectReader& item, std::string_view key);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
