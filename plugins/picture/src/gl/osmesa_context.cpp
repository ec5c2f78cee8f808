#include "gl/osmesa_context.h"

#if SOFTPOINT_PICTURE_OSMESA

#include <GL/osmesa.h>

#include <array>
#include <cstdint>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

class OsmesaContext final : public GlContext {
 public:
  OsmesaContext() {
    const int attributes[] = {OSMESA_FORMAT,
                              OSMESA_RGBA,
                              OSMESA_DEPTH_BITS,
                              0,
                              OSMESA_PROFILE,
                              OSMESA_CORE_PROFILE,
                              OSMESA_CONTEXT_MAJOR_VERSION,
                              3,
                              OSMESA_CONTEXT_MINOR_VERSION,
                              3,
                              0};
    context_ = OSMesaCreateContextAttribs(attributes, nullptr);
    if (!context_) throw Error("this Mesa gives no OpenGL 3.3 core context");
  }

  ~OsmesaContext() override { OSMesaDestroyContext(context_); }

  void make_current() override {
    if (!OSMesaMakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, kBufferSide, kBufferSide)) {
      throw Error("the context cannot be made current");
    }
  }

  void release() override {
    if (OSMesaGetCurrentContext() == context_) OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
  }

  Function function(const char* name) const override { return OSMesaGetProcAddress(name); }
  Backend backend() const override { return Backend::kOsmesa; }

 private:
  // OSMesa wants a window-like buffer of its own; nothing is ever drawn into it.
  static constexpr int kBufferSide = 16;

  OSMesaContext context_ = nullptr;
  alignas(16) std::array<std::uint8_t, 4 * kBufferSide * kBufferSide> buffer_{};
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() { return std::make_unique<OsmesaContext>(); }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture

#endif
