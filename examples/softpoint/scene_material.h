#pragma once

#include "json_reader.h"
#include "softpoint/elastic/material.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The object at "material".
elastic::Material read_material(ObjectReader& item);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
