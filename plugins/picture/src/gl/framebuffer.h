#pragma once

#include <cstdint>
#include <vector>

#include "gl/api.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Colour and depth with several samples a pixel, and the plain colour buffer they resolve into.
class Framebuffer {
 public:
  // Throws Error when the driver cannot hold `width` x `height` pixels.
  Framebuffer(const GlApi& gl, int width, int height, int samples);
  Framebuffer(const Framebuffer&) = delete;
  Framebuffer& operator=(const Framebuffer&) = delete;
  ~Framebuffer();

  // Makes the multisampled buffer the target of what is drawn next.
  void bind() const;
  // Averages the samples and copies them to `rgba`, top row first; `rgba` holds 4 width height bytes.
  void read(std::vector<std::uint8_t>& rgba) const;

 private:
  void release();

  const GlApi& gl_;
  int width_, height_;
  GLuint drawn_ = 0, resolved_ = 0;
  GLuint color_ = 0, depth_ = 0, plain_color_ = 0;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
