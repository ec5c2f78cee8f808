#pragma once

#include <span>
#include <vector>

#include "softpoint/cloth/pattern.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// A few nodes over the whole cloth that carry its points along: hat functions on a grid, smoothed patches on
// any mesh. Its matrix is P^T H P, banded; equations (10) to (12) of doc/solver.md.
class CoarseLevel {
 public:
  static constexpr int kCorners = 4;  // nodes that carry a point

  // About `side` points along each side of a patch, more where there would be too many patches.
  CoarseLevel(const ClothPattern& pattern, int side);

  int nodes() const { return nodes_; }

  // Begins a matrix with the inertia of the points: mass entries (N/m), 0 for those that do not move.
  void begin(std::span<const double> inertia);
  // Adds a spring: its 3 x 3 Hessian xx yy zz xy xz yz, and which ends move.
  void add_spring(int spring, const double (&h)[6], bool a_moves, bool b_moves);
  // Adds a bending element of the pattern.
  void add_bend(int bend, double stiffness, std::span<const char> moves);
  // False when the matrix is not positive definite.
  bool factor();

  // 3 numbers a node.
  std::span<double> right_side() { return right_; }
  void add_to(std::span<double> right, int point, const Vec3& value) const {
    for (int k = 0; k < kCorners; ++k) {
      const double w = weight_[kCorners * point + k];
      double* r = right.data() + 3 * node_[kCorners * point + k];
      for (int c = 0; c < 3; ++c) r[c] += w * value[c];
    }
  }
  Vec3 value_at(std::span<const double> x, int point) const {
    Vec3 v = Vec3::Zero();
    for (int k = 0; k < kCorners; ++k) {
      const double w = weight_[kCorners * point + k];
      const double* r = x.data() + 3 * node_[kCorners * point + k];
      for (int c = 0; c < 3; ++c) v[c] += w * r[c];
    }
    return v;
  }
  void solve(std::span<double> x) const;

 private:
  struct Link {
    int count;
    int node[2 * kCorners];
    double a[2 * kCorners], b[2 * kCorners];
  };

  void lay_grid(const ClothPattern& pattern, int side);
  void lay_mesh(const ClothPattern& pattern, int side);
  void add_pair(int k, int l, double factor, const double (&h)[6]);

  int nodes_ = 0, band_ = 0;  // entries left of the diagonal
  std::vector<int> node_;     // per point, kCorners
  std::vector<double> weight_;
  std::vector<Link> links_;  // per spring
  std::vector<BendElement> bends_;
  std::vector<double> matrix_;  // rows of band_ + 1, the diagonal last
  std::vector<double> right_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
