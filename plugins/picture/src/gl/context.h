#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// The seam between the renderer and whatever lends it an OpenGL 3.3 core context without a window. The
// renderer draws into framebuffers of its own, so a context has no size.
class GlContext {
 public:
  using Function = void (*)();

  GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  virtual ~GlContext() = default;

  // Binds the context to the calling thread; throws Error if the driver refuses.
  virtual void make_current() = 0;
  // Address of an OpenGL function ("glClear"), null when the driver has none.
  virtual Function function(const char* name) const = 0;
  virtual std::string_view backend() const = 0;
};

// Permitted names: "osmesa". Throws Error for any other, and when the context cannot be made.
std::unique_ptr<GlContext> make_gl_context(std::string_view backend);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
