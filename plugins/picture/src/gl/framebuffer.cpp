#include "gl/framebuffer.h"

#include <algorithm>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

Framebuffer::Framebuffer(const GlApi& gl, int width, int height, int samples)
    : gl_(gl), width_(width), height_(height) {
  while (gl.GetError() != GL_NO_ERROR) continue;  // errors of others are not ours to report
  const auto renderbuffer = [&](GLenum format, int sample_count) {
    GLuint id = 0;
    gl.GenRenderbuffers(1, &id);
    gl.BindRenderbuffer(GL_RENDERBUFFER, id);
    if (sample_count > 1) {
      gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, sample_count, format, width, height);
    } else {
      gl.RenderbufferStorage(GL_RENDERBUFFER, format, width, height);
    }
    return id;
  };
  color_ = renderbuffer(GL_RGBA8, samples);
  depth_ = renderbuffer(GL_DEPTH_COMPONENT24, samples);
  plain_color_ = renderbuffer(GL_RGBA8, 1);

  gl.GenFramebuffers(1, &drawn_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  const bool drawn_complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  gl.GenFramebuffers(1, &resolved_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, resolved_);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, plain_color_);
  const bool resolved_complete = gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;

  if (gl.GetError() != GL_NO_ERROR || !drawn_complete || !resolved_complete) {
    release();
    throw Error("picture size = " + std::to_string(width) + "x" + std::to_string(height) + " with " +
                std::to_string(samples) + " samples: the driver has no such framebuffer");
  }
}

Framebuffer::~Framebuffer() { release(); }

void Framebuffer::release() {
  const GLuint framebuffers[] = {drawn_, resolved_};
  gl_.DeleteFramebuffers(2, framebuffers);
  const GLuint renderbuffers[] = {color_, depth_, plain_color_};
  gl_.DeleteRenderbuffers(3, renderbuffers);
}

void Framebuffer::bind() const {
  gl_.BindFramebuffer(GL_FRAMEBUFFER, drawn_);
  gl_.Viewport(0, 0, width_, height_);
}

void Framebuffer::read(std::vector<std::uint8_t>& rgba) const {
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, drawn_);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_);
  gl_.BlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, resolved_);
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  // OpenGL's first row is the lowest one.
  const auto row = [&](int y) { return rgba.begin() + std::ptrdiff_t{4} * width_ * y; };
  for (int y = 0; y < height_ / 2; ++y) {
    std::swap_ranges(row(y), row(y + 1), row(height_ - 1 - y));
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
