#pragma once

#include <span>
#include <vector>

#include "box_tree.h"
#include "softpoint/core/deformable.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A point of a deformable's skin seen from a point of space.
struct SkinPoint {
  int face = -1;
  Vec3 weights = Vec3::Zero();
  Vec3 outward = Vec3::UnitY();
  double distance = 0;  // m, negative inside
};

// The skin of one deformable in the configuration that the end of the step would have, ready for queries.
class Skin {
 public:
  // Forgets the last pass: update() has work to do again.
  void expire() { current_ = false; }
  void update(const Deformable& body);

  const Deformable& body() const { return *body_; }
  const Bounds& bounds() const { return faces_.bounds(); }
  Vec3 size() const { return bounds().high - bounds().low; }
  double travel() const { return travel_; }     // m, farthest any point moves over the step
  const Vec3& drift() const { return drift_; }  // m, mean motion over the step
  const BoxTree& faces() const { return faces_; }
  const BoxTree& edges() const { return edges_; }

  std::span<const std::array<int, 2>> edge_vertices() const { return body_->edges_; }
  std::span<const std::array<int, 2>> edge_faces() const { return body_->edge_faces_; }
  const std::vector<Vec3>& start() const { return body_->positions_; }
  const std::vector<Vec3>& end() const { return body_->end_positions_; }
  // Points of the skin at which the torque of impulses is counted.
  const std::vector<Vec3>& impulse_points() const { return body_->impulse_points_; }
  const Triangle& triangle(int face) const { return body_->triangles_[static_cast<std::size_t>(face)]; }
  // Outward unit normal of a face at the start or the end of the step.
  Vec3 face_normal(int face, bool at_start) const;
  // The smooth outward normal at a vertex or within a face (not normalised).
  const Vec3& vertex_normal(int vertex) const { return normals_[static_cast<std::size_t>(vertex)]; }
  Vec3 smooth_normal(int face, const Vec3& weights) const;

  // First face that the segment enters from outside.
  bool crossed_face(const Vec3& from, const Vec3& to, SkinPoint& hit) const;
  // Nearest point of the skin with its signed distance; false beyond `reach`.
  bool nearest_face(const Vec3& p, double reach, SkinPoint& nearest) const;
  // Where the line through `p` along `direction` meets the skin from outside, nearest to p and not farther
  // than `reach`; the distance is negative when p has passed it.
  bool along(const Vec3& p, const Vec3& direction, double reach, SkinPoint& hit) const;
  // Whether p lies inside the closed skin.
  bool inside(const Vec3& p) const;

 private:
  bool segment_meets_front(int face, const Vec3& from, const Vec3& d, double& time, Vec3& weights) const;

  const Deformable* body_ = nullptr;
  bool current_ = false;
  BoxTree faces_, edges_;
  std::vector<Bounds> face_boxes_, edge_boxes_;
  std::vector<Vec3> normals_;  // smooth, at the vertices
  double travel_ = 0;
  Vec3 drift_ = Vec3::Zero();
};

}  // namespace softpoint::inline SOFTPOINT_ABI
