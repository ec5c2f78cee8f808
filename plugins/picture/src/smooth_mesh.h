#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "softpoint/core/vec.h"
#include "view.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {

// A triangle surface whose vertices are doubled along sharp edges, so that every copy has one normal.
class SmoothMesh {
 public:
  static constexpr int kFloatsPerVertex = 6;  // position, normal

  // Throws Error for an index out of range, a non-finite vertex, or no triangle at all.
  SmoothMesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles, double crease_degrees);

  // New positions of the original vertices: recomputes normals and bounds. Throws Error on another count.
  void move(std::span<const Vec3> vertices);

  const std::vector<float>& vertex_data() const { return data_; }
  const std::vector<std::uint32_t>& indices() const { return indices_; }
  // Every edge of the original surface once, as vertices of vertex_data().
  const std::vector<std::array<std::uint32_t, 2>>& edges() const { return edges_; }
  Vec3 position(std::uint32_t i) const {
    const float* p = data_.data() + std::size_t{kFloatsPerVertex} * i;
    return {p[0], p[1], p[2]};
  }
  int triangle_count() const { return static_cast<int>(indices_.size() / 3); }
  const Box& bounds() const { return bounds_; }
  // False when a vertex moved to a non-finite place; such a mesh is not drawn.
  bool finite() const { return finite_; }

 private:
  std::size_t vertex_count_ = 0;        // of the original surface
  std::vector<std::uint32_t> source_;   // copy -> original vertex
  std::vector<std::uint32_t> indices_;  // three copies a triangle
  std::vector<std::array<std::uint32_t, 2>> edges_;
  std::vector<float> data_;
  std::vector<Vec3> normals_;  // scratch of move(), one a copy
  Box bounds_;
  bool finite_ = true;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
