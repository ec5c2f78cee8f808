#include "overlay.h"

#include <cstddef>

#include "shaders/overlay.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

void store(float (&out)[3], const Vec3& v) {
  for (int c = 0; c < 3; ++c) out[c] = static_cast<float>(v[c]);
}

void store(float (&out)[4], Color color) {
  out[0] = color.r;
  out[1] = color.g;
  out[2] = color.b;
  out[3] = color.a;
}

}  // namespace

Overlay::Overlay(const GlApi& gl)
    : gl_(gl),
      line_program_(gl, "line", kLineVertex, kFlatFragment),
      point_program_(gl, "point", kPointVertex, kPointFragment),
      triangle_program_(gl, "triangle", kTriangleVertex, kFlatFragment),
      line_buffer_(gl),
      point_buffer_(gl),
      triangle_buffer_(gl) {
  gl.GenVertexArrays(3, arrays_);
  gl.BindVertexArray(arrays_[0]);
  gl.BindBuffer(GL_ARRAY_BUFFER, line_buffer_.id());
  set_attribute(gl, 0, 3, sizeof(Line), offsetof(Line, from), 1);
  set_attribute(gl, 1, 3, sizeof(Line), offsetof(Line, to), 1);
  set_attribute(gl, 2, 4, sizeof(Line), offsetof(Line, color), 1);
  set_attribute(gl, 3, 1, sizeof(Line), offsetof(Line, width), 1);
  gl.BindVertexArray(arrays_[1]);
  gl.BindBuffer(GL_ARRAY_BUFFER, point_buffer_.id());
  set_attribute(gl, 0, 3, sizeof(Point), offsetof(Point, center), 1);
  set_attribute(gl, 1, 4, sizeof(Point), offsetof(Point, color), 1);
  set_attribute(gl, 2, 1, sizeof(Point), offsetof(Point, radius), 1);
  gl.BindVertexArray(arrays_[2]);
  gl.BindBuffer(GL_ARRAY_BUFFER, triangle_buffer_.id());
  set_attribute(gl, 0, 3, sizeof(Vertex), offsetof(Vertex, place), 0);
  set_attribute(gl, 1, 4, sizeof(Vertex), offsetof(Vertex, color), 0);
}

Overlay::~Overlay() { gl_.DeleteVertexArrays(3, arrays_); }

void Overlay::clear() {
  for (Layer* layer : {&hidden_by_solids_, &see_through_}) {
    layer->lines.clear();
    layer->points.clear();
  }
  triangles_.clear();
}

void Overlay::add_line(const Vec3& from, const Vec3& to, Color color, double width_pixels, bool see_through) {
  Line& line = (see_through ? see_through_ : hidden_by_solids_).lines.emplace_back();
  store(line.from, from);
  store(line.to, to);
  store(line.color, color);
  line.width = static_cast<float>(width_pixels);
}

void Overlay::add_point(const Vec3& center, Color color, double radius_pixels, bool see_through) {
  Point& point = (see_through ? see_through_ : hidden_by_solids_).points.emplace_back();
  store(point.center, center);
  store(point.color, color);
  point.radius = static_cast<float>(radius_pixels);
}

void Overlay::add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, Color color) {
  for (const Vec3* place : {&a, &b, &c}) {
    Vertex& vertex = triangles_.emplace_back();
    store(vertex.place, *place);
    store(vertex.color, color);
  }
}

void Overlay::draw_lines(const std::vector<Line>& lines) {
  if (lines.empty()) return;
  line_buffer_.fill(lines);
  line_program_.use();
  gl_.BindVertexArray(arrays_[0]);
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(lines.size()));
}

void Overlay::draw_points(const std::vector<Point>& points) {
  if (points.empty()) return;
  point_buffer_.fill(points);
  point_program_.use();
  gl_.BindVertexArray(arrays_[1]);
  gl_.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(points.size()));
}

void Overlay::draw_triangles() {
  if (triangles_.empty()) return;
  triangle_buffer_.fill(triangles_);
  triangle_program_.use();
  gl_.BindVertexArray(arrays_[2]);
  gl_.DepthMask(GL_FALSE);
  gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles_.size()));
  gl_.DepthMask(GL_TRUE);
}

void Overlay::draw() {
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);  // the picture stays opaque
  draw_triangles();
  draw_lines(hidden_by_solids_.lines);
  draw_points(hidden_by_solids_.points);
  gl_.Disable(GL_DEPTH_TEST);
  draw_lines(see_through_.lines);
  draw_points(see_through_.points);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.Disable(GL_BLEND);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
