#include "gl/egl_context.h"

#if SOFTPOINT_PICTURE_EGL

// Without these the header asks for those of X11.
#define EGL_NO_X11
#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <string_view>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// With the code EGL left behind.
Error egl_error(const std::string& what) {
  char code[16];
  std::snprintf(code, sizeof code, "0x%04X", static_cast<unsigned>(eglGetError()));
  return Error(what + " (EGL error " + code + ")");
}

// EGL lists extensions as words between blanks.
bool lists(const char* extensions, std::string_view name) {
  std::string_view rest = extensions ? extensions : "";
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(' '), rest.size());
    if (rest.substr(0, end) == name) return true;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return false;
}

// "Which API do context calls mean" is a setting of the thread, and may be OpenGL ES for an application.
class OpenGlBound {
 public:
  OpenGlBound() : before_(eglQueryAPI()) {
    if (!eglBindAPI(EGL_OPENGL_API)) throw egl_error("this EGL has no OpenGL");
  }
  OpenGlBound(const OpenGlBound&) = delete;
  OpenGlBound& operator=(const OpenGlBound&) = delete;
  ~OpenGlBound() {
    if (before_ != EGL_NONE) eglBindAPI(before_);
  }

 private:
  EGLenum before_;
};

EGLDisplay open_display() {
  if (!lists(eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless")) {
    throw Error("this EGL has no EGL_MESA_platform_surfaceless");
  }
  const EGLDisplay display =
      eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) throw egl_error("no surfaceless display");
  if (!eglInitialize(display, nullptr, nullptr)) throw egl_error("the display cannot be initialised");
  const char* extensions = eglQueryString(display, EGL_EXTENSIONS);
  for (const char* needed : {"EGL_KHR_surfaceless_context", "EGL_KHR_no_config_context"}) {
    if (!lists(extensions, needed)) throw Error("the display has no " + std::string(needed));
  }
  return display;
}

// One for the process and never terminated: EGL would hand the same display to an application that asks for
// it too, and terminating it ends the contexts of all.
EGLDisplay display_of_process() {
  static const EGLDisplay display = open_display();
  return display;
}

class EglContext final : public GlContext {
 public:
  EglContext() : display_(display_of_process()) {
    const OpenGlBound bound;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 3,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 3,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context_ == EGL_NO_CONTEXT) throw egl_error("the driver gives no OpenGL 3.3 core context");
  }

  ~EglContext() override {
    release();  // a current one would live on
    eglDestroyContext(display_, context_);
  }

  void make_current() override {
    const OpenGlBound bound;
    // To EGL a context that it made current last still is, even when another library has put its own in
    // Mesa's one slot per thread meanwhile, as OSMesa does: only letting go first binds it again.
    release();
    if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
      throw egl_error("the context cannot be made current");
    }
  }

  void release() override {
    if (eglGetCurrentContext() != context_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  }

  Function function(const char* name) const override { return eglGetProcAddress(name); }
  Backend backend() const override { return Backend::kEgl; }

 private:
  EGLDisplay display_;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> make_egl_context() { return std::make_unique<EglContext>(); }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#endif
