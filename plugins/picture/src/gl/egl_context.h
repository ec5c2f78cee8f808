#pragma once

#include "gl/context.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// EGL on Mesa's surfaceless platform: no window system, graphics hardware where there is any. Throws Error
// when the platform or an OpenGL 3.3 core context is missing.
std::unique_ptr<GlContext> make_egl_context();

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
