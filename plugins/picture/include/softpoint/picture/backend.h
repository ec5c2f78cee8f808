#pragma once

#include <string_view>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// What lends a renderer its OpenGL context. Each is in a build or not, as the build was told.
enum class Backend {
  // The one that the environment variable SOFTPOINT_PICTURE_BACKEND names (auto, osmesa, egl); without it the
  // first that works, in the order below.
  kAuto,
  // Mesa's software rasteriser inside this process: no graphics hardware, the same pictures everywhere.
  kOsmesa,
  // EGL without a window system (surfaceless): the machine's graphics hardware where there is any.
  kEgl,
};

// "auto", "osmesa", "egl".
SOFTPOINT_API std::string_view backend_name(Backend backend);

// Those in this build, in the order in which kAuto tries them; whether they work here only a renderer tells.
SOFTPOINT_API std::vector<Backend> built_backends();

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
