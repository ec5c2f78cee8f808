#pragma once

#include "gl/program.h"
#include "gl/stream_buffer.h"
#include "softpoint/picture/image.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

struct GroundDraw {
  Vec3 normal{0, 1, 0};  // unit
  double offset = 0;     // normal . x
  Color color;
};

// Draws unbounded planes as fans of triangles round the eye's foot, with a filtered grid.
class GroundPainter {
 public:
  explicit GroundPainter(const GlApi& gl);
  GroundPainter(const GroundPainter&) = delete;
  GroundPainter& operator=(const GroundPainter&) = delete;
  ~GroundPainter() { gl_.DeleteVertexArrays(1, &array_); }

  // `spacing` in metres between lines, 0 for none. Leaves out planes seen from below.
  void draw(const View& view, const GroundDraw& ground, double spacing, double radius) const;

 private:
  const GlApi& gl_;
  Program program_;
  StreamBuffer fan_;
  GLuint array_ = 0;
  GLint plane_, axis_u_, axis_v_, paint_, reach_;
};

// The power of ten that puts some ten lines between the eye and its target.
double automatic_spacing(const View& view);

// Radius of the fan, metres.
double ground_radius(const View& view, double height);

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
