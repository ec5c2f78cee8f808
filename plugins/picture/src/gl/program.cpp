#include "gl/program.h"

#include <array>
#include <string>

#include "shaders/common.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// Owns the shader object until the program has taken what it needs of it.
class Shader {
 public:
  Shader(const GlApi& gl, GLenum stage, std::string_view name, std::string_view library,
         std::string_view text)
      : gl_(gl), id_(gl.CreateShader(stage)) {
    std::string whole(kShaderPrologue);
    whole += library;
    whole += text;
    const GLchar* start = whole.c_str();
    gl.ShaderSource(id_, 1, &start, nullptr);
    gl.CompileShader(id_);
    GLint compiled = 0;
    gl.GetShaderiv(id_, GL_COMPILE_STATUS, &compiled);
    if (compiled) return;
    std::array<char, 1024> log{};
    gl.GetShaderInfoLog(id_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    gl.DeleteShader(id_);
    throw Error("shader \"" + std::string(name) + "\" does not compile: " + log.data());
  }
  Shader(const Shader&) = delete;
  Shader& operator=(const Shader&) = delete;
  ~Shader() { gl_.DeleteShader(id_); }

  GLuint id() const { return id_; }

 private:
  const GlApi& gl_;
  GLuint id_;
};

}  // namespace

Program::Program(const GlApi& gl, std::string_view name, std::string_view vertex, std::string_view fragment,
                 std::string_view library)
    : gl_(gl) {
  const Shader vertex_shader(gl, GL_VERTEX_SHADER, name, {}, vertex);
  const Shader fragment_shader(gl, GL_FRAGMENT_SHADER, name, library, fragment);
  program_ = gl.CreateProgram();
  gl.AttachShader(program_, vertex_shader.id());
  gl.AttachShader(program_, fragment_shader.id());
  gl.LinkProgram(program_);
  GLint linked = 0;
  gl.GetProgramiv(program_, GL_LINK_STATUS, &linked);
  if (!linked) {
    std::array<char, 1024> log{};
    gl.GetProgramInfoLog(program_, static_cast<GLsizei>(log.size()), nullptr, log.data());
    gl.DeleteProgram(program_);
    throw Error("shader \"" + std::string(name) + "\" does not link: " + log.data());
  }
  const GLuint block = gl.GetUniformBlockIndex(program_, "Frame");
  if (block != GL_INVALID_INDEX) gl.UniformBlockBinding(program_, block, 0);
  const GLint shadow_map = uniform("shadow_map");
  if (shadow_map >= 0) {
    gl.UseProgram(program_);
    gl.Uniform1i(shadow_map, 0);
  }
}

Program::~Program() { gl_.DeleteProgram(program_); }

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
