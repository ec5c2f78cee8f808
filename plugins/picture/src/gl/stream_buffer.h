#pragma once

#include <algorithm>
#include <vector>

#include "gl/api.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A vertex buffer that is filled anew every frame; it grows and never shrinks.
class StreamBuffer {
 public:
  explicit StreamBuffer(const GlApi& gl) : gl_(gl) { gl.GenBuffers(1, &id_); }
  StreamBuffer(const StreamBuffer&) = delete;
  StreamBuffer& operator=(const StreamBuffer&) = delete;
  ~StreamBuffer() { gl_.DeleteBuffers(1, &id_); }

  GLuint id() const { return id_; }

  template <class T>
  void fill(const std::vector<T>& items) {
    gl_.BindBuffer(GL_ARRAY_BUFFER, id_);
    const auto bytes = static_cast<GLsizeiptr>(items.size() * sizeof(T));
    if (bytes > capacity_) {
      capacity_ = std::max<GLsizeiptr>(bytes + bytes / 2, 4096);
      gl_.BufferData(GL_ARRAY_BUFFER, capacity_, nullptr, GL_STREAM_DRAW);
    }
    if (bytes > 0) gl_.BufferSubData(GL_ARRAY_BUFFER, 0, bytes, items.data());
  }

 private:
  const GlApi& gl_;
  GLuint id_ = 0;
  GLsizeiptr capacity_ = 0;
};

// Declares attribute `location` of the bound vertex array: `floats` floats at `offset` bytes, `stride` bytes
// apart in the bound buffer, one set a vertex (divisor 0) or an instance (divisor 1).
inline void set_attribute(const GlApi& gl, GLuint location, int floats, std::size_t stride,
                          std::size_t offset, GLuint divisor) {
  gl.EnableVertexAttribArray(location);
  gl.VertexAttribPointer(location, floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                         reinterpret_cast<const void*>(offset));
  gl.VertexAttribDivisor(location, divisor);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
