#include "gl/api.h"

#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

GlContext::Function find(const GlContext& context, const char* name) {
  const GlContext::Function function = context.function(name);
  if (!function) throw Error("the driver has no " + std::string(name));
  return function;
}

}  // namespace

GlApi::GlApi(const GlContext& context) {
#define SOFTPOINT_GL_LOAD(type, name) name = reinterpret_cast<type>(find(context, "gl" #name));
  SOFTPOINT_GL_FUNCTIONS(SOFTPOINT_GL_LOAD)
#undef SOFTPOINT_GL_LOAD
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
