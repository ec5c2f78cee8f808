#pragma once

#include <memory>
#include <span>

#include "softpoint/core/config.h"
#include "softpoint/picture/backend.h"

// Which backends this build holds is for the build to say; a plain compiler line gets OSMesa.
#if !defined(SOFTPOINT_PICTURE_OSMESA) && !defined(SOFTPOINT_PICTURE_EGL)
#define SOFTPOINT_PICTURE_OSMESA 1
#endif

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

  // Binds the context to the calling thread, whatever was bound there by whom; throws Error if the driver
  // refuses.
  virtual void make_current() = 0;
  // Leaves the calling thread without a context if it has this one, so that another thread may have it.
  virtual void release() = 0;
  // Address of an OpenGL function ("glClear"), null when the driver has none.
  virtual Function function(const char* name) const = 0;
  virtual Backend backend() const = 0;
};

// Current for as long as this object lives.
class CurrentContext {
 public:
  explicit CurrentContext(GlContext& context) : context_(context) { context_.make_current(); }
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;
  ~CurrentContext() { context_.release(); }

 private:
  GlContext& context_;
};

struct BackendEntry {
  Backend backend;
  // Throws Error, the message being the reason alone.
  std::unique_ptr<GlContext> (*make)();
};

// A context of `wanted`, current on the calling thread and with every function the renderer calls. `kAuto`
// asks `environment` (the value of SOFTPOINT_PICTURE_BACKEND, null or "" if not set) and then takes the first
// of `built` that works. Throws Error with what was tried and why it failed.
std::unique_ptr<GlContext> choose_gl_context(std::span<const BackendEntry> built, Backend wanted,
                                             const char* environment);

// The same among the backends of this build, with the environment of this process.
std::unique_ptr<GlContext> make_gl_context(Backend wanted);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
