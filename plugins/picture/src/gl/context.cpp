#include "gl/context.h"

#include "gl/osmesa_context.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

struct Backend {
  std::string_view name;
  std::unique_ptr<GlContext> (*make)();
};

constexpr Backend kBackends[] = {{"osmesa", &make_osmesa_context}};

}  // namespace

std::unique_ptr<GlContext> make_gl_context(std::string_view backend) {
  std::string permitted;
  for (const Backend& candidate : kBackends) {
    if (candidate.name == backend) return candidate.make();
    permitted += (permitted.empty() ? "" : ", ") + std::string(candidate.name);
  }
  throw Error("renderer backend = \"" + std::string(backend) + "\": permitted is " + permitted);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
