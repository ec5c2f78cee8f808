#include "gl/context.h"

#include <cstdlib>
#include <string>

#include "gl/api.h"
#include "gl/egl_context.h"
#include "gl/osmesa_context.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr const char* kVariable = "SOFTPOINT_PICTURE_BACKEND";

// The order in which kAuto tries them. OSMesa first: its pictures do not depend on the machine's graphics
// hardware.
constexpr BackendEntry kBuilt[] = {
#if SOFTPOINT_PICTURE_OSMESA
    {Backend::kOsmesa, &make_osmesa_context},
#endif
#if SOFTPOINT_PICTURE_EGL
    {Backend::kEgl, &make_egl_context},
#endif
};

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

// `field` = "value": permitted is auto, ...
Error not_permitted(std::string_view field, std::string_view value, std::span<const BackendEntry> built) {
  std::string permitted(backend_name(Backend::kAuto));
  for (const BackendEntry& entry : built) permitted += ", " + std::string(backend_name(entry.backend));
  return Error(std::string(field) + " = " + quoted(value) + ": permitted in this build is " + permitted);
}

Backend named(std::span<const BackendEntry> built, std::string_view text) {
  if (text.empty() || text == backend_name(Backend::kAuto)) return Backend::kAuto;
  for (const BackendEntry& entry : built) {
    if (text == backend_name(entry.backend)) return entry.backend;
  }
  throw not_permitted(kVariable, text, built);
}

std::unique_ptr<GlContext> make_working(const BackendEntry& entry) {
  std::unique_ptr<GlContext> context = entry.make();
  context->make_current();
  GlApi{*context};  // throws for a function the driver lacks
  return context;
}

}  // namespace

std::string_view backend_name(Backend backend) {
  switch (backend) {
    case Backend::kAuto:
      return "auto";
    case Backend::kOsmesa:
      return "osmesa";
    case Backend::kEgl:
      return "egl";
  }
  return "unknown";
}

std::vector<Backend> built_backends() {
  std::vector<Backend> backends;
  for (const BackendEntry& entry : kBuilt) backends.push_back(entry.backend);
  return backends;
}

std::unique_ptr<GlContext> choose_gl_context(std::span<const BackendEntry> built, Backend wanted,
                                             const char* environment) {
  std::string field = "backend";
  if (wanted == Backend::kAuto) {
    wanted = named(built, environment ? environment : "");
    if (wanted != Backend::kAuto) field = kVariable;
  }
  std::string tried;
  for (const BackendEntry& entry : built) {
    if (wanted != Backend::kAuto && entry.backend != wanted) continue;
    try {
      return make_working(entry);
    } catch (const Error& error) {
      tried += (tried.empty() ? "" : "; ") + std::string(backend_name(entry.backend)) + ": " + error.what();
    }
  }
  if (tried.empty()) throw not_permitted(field, backend_name(wanted), built);
  throw Error(field + " = " + quoted(backend_name(wanted)) + ": no OpenGL 3.3 here; tried " + tried);
}

std::unique_ptr<GlContext> make_gl_context(Backend wanted) {
  return choose_gl_context(kBuilt, wanted, std::getenv(kVariable));
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
