#pragma once

#include <string_view>

#include "gl/api.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A linked vertex and fragment shader. Both get the prologue of shaders/common.h in front and read the
// FrameBlock of binding 0; sampler "shadow_map" sits on texture unit 0.
class Program {
 public:
  // Throws Error with the driver's log when the text does not compile or link.
  // `library` are functions for the fragment shader, e.g. kLighting.
  Program(const GlApi& gl, std::string_view name, std::string_view vertex, std::string_view fragment,
          std::string_view library = {});
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  void use() const { gl_.UseProgram(program_); }
  GLint uniform(const char* name) const { return gl_.GetUniformLocation(program_, name); }

 private:
  const GlApi& gl_;
  GLuint program_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
