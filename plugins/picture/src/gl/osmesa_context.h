#pragma once

#include "gl/context.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Mesa's software rasteriser, without a display server. Throws Error when Mesa has no 3.3 core context.
std::unique_ptr<GlContext> make_osmesa_context();

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
