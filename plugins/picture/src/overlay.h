#pragma once

#include <vector>

#include "gl/program.h"
#include "gl/stream_buffer.h"
#include "softpoint/picture/image.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// Lines, points and flat triangles of one frame, in eye-relative coordinates.
class Overlay {
 public:
  explicit Overlay(const GlApi& gl);
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;
  ~Overlay();

  void clear();
  void add_line(const Vec3& from, const Vec3& to, Color color, double width_pixels, bool see_through);
  void add_point(const Vec3& center, Color color, double radius_pixels, bool see_through);
  void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, Color color);
  // After everything solid has been drawn.
  void draw();

 private:
  struct Line {
    float from[3], to[3], color[4], width;
  };
  struct Point {
    float center[3], color[4], radius;
  };
  struct Vertex {
    float place[3], color[4];
  };
  struct Layer {
    std::vector<Line> lines;
    std::vector<Point> points;
  };

  void draw_lines(const std::vector<Line>& lines);
  void draw_points(const std::vector<Point>& points);
  void draw_triangles();

  const GlApi& gl_;
  Program line_program_, point_program_, triangle_program_;
  StreamBuffer line_buffer_, point_buffer_, triangle_buffer_;
  GLuint arrays_[3] = {};
  Layer hidden_by_solids_, see_through_;
  std::vector<Vertex> triangles_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
