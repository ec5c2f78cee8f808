#pragma once

#include <array>
#include <span>
#include <vector>

#include "softpoint/cloth/pattern.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// The faces of a cloth in patches of some fifty, with what tells quickly that two of them cannot meet: boxes,
// and for neighbours the cone of their normals. A patch, or two that share points, whose normals all lie
// within a cone under a right angle does not fold back upon itself.
class SelfPatches {
 public:
  struct Edge {
    int a = 0, b = 0;
  };
  // What a face stands for when faces are compared pair by pair, so that nothing is compared twice: each
  // point and each edge is owned by one face.
  struct Owned {
    std::array<int, 3> points{-1, -1, -1};
    std::array<int, 3> edges{-1, -1, -1};
  };

  explicit SelfPatches(const ClothPattern& pattern);

  std::span<const Triangle> faces() const { return faces_; }
  std::span<const Edge> edges() const { return edges_; }
  const Owned& owned(int face) const { return owned_[static_cast<std::size_t>(face)]; }

  // Boxes and cones at these positions; boxes are grown by `reach` (m).
  void measure(std::span<const Vec3> positions, double reach);
  // Calls visit(face, other) for each pair of faces whose grown boxes meet and whose patches are not known to
  // keep apart. Returns the number of pairs of patches looked at.
  template <class Visit>
  int near_faces(std::span<const Vec3> positions, double reach, Visit visit) {
    int looked = 0;
    boxed_.assign(patches_.size(), 0);
    for (std::size_t a = 0; a < patches_.size(); ++a) {
      for (std::size_t b = a; b < patches_.size(); ++b) {
        if (!may_meet(a, b)) {
          continue;
        }
        ++looked;
        box_faces(a, positions, reach);
        box_faces(b, positions, reach);
        compare(a, b, visit);
      }
    }
    return looked;
  }

 private:
  struct Box {
    float low[3], high[3];
    bool meets(const Box& other) const {
      return low[0] <= other.high[0] && other.low[0] <= high[0] && low[1] <= other.high[1] &&
             other.low[1] <= high[1] && low[2] <= other.high[2] && other.low[2] <= high[2];
    }
  };
  struct Patch {
    std::vector<int> faces;
    std::vector<int> points;
    Box box{};
    Vec3 axis = Vec3::UnitZ();  // of the cone of normals
    double cosine = 1;          // of its half angle
  };

  void cut(const ClothPattern& pattern);
  bool may_meet(std::size_t a, std::size_t b) const;
  bool touch(std::size_t a, std::size_t b) const { return neighbours_[a * patches_.size() + b] != 0; }
  void box_faces(std::size_t patch, std::span<const Vec3> positions, double reach);

  template <class Visit>
  void compare(std::size_t a, std::size_t b, Visit visit) {
    pick(a, patches_[b].box, first_);
    if (a == b) {
      for (std::size_t i = 0; i < first_.size(); ++i) {
        for (std::size_t j = i + 1; j < first_.size(); ++j) {
          if (box_of(first_[i]).meets(box_of(first_[j])) && !unfolded(first_[i], first_[j])) {
            visit(first_[i], first_[j]);
          }
        }
      }
      return;
    }
    pick(b, patches_[a].box, second_);
    for (const int f : first_) {
      const Box box = box_of(f);
      for (const int g : second_) {
        if (box.meets(box_of(g)) && !unfolded(f, g)) {
          visit(f, g);
        }
      }
    }
  }
  void pick(std::size_t patch, const Box& region, std::vector<int>& out) const;
  // Two faces that share an edge and are not folded against each other. (Those that share a point only may
  // lie on each other in a pleat, facing the same way.)
  bool unfolded(int face, int other) const {
    const auto f = static_cast<std::size_t>(face), g = static_cast<std::size_t>(other);
    const std::array<float, 3>&a = normals_[f], &b = normals_[g];
    if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] < kUnfolded) {
      return false;
    }
    const Triangle &t = faces_[f], &o = faces_[g];
    int shared = 0;
    for (const int v : t) {
      shared += v == o[0] || v == o[1] || v == o[2];
    }
    return shared >= 2;
  }
  const Box& box_of(int face) const { return boxes_[static_cast<std::size_t>(face)]; }

  std::vector<Triangle> faces_;
  std::vector<Edge> edges_;
  std::vector<Owned> owned_;
  std::vector<Patch> patches_;
  std::vector<char> neighbours_;               // patches that share a point
  std::vector<Box> boxes_;                     // of faces
  std::vector<std::array<float, 3>> normals_;  // of faces
  static constexpr float kUnfolded = 0.26f;    // cosine
  std::vector<char> boxed_;                    // patches whose faces have theirs
  std::vector<int> first_, second_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
