#pragma once

#include "json_reader.h"
#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// "camera", "pictures" and "video"; bodies are known already.
void read_view(ObjectReader& root, Scene& scene);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
