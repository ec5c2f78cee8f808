#pragma once

#include <span>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// An axis-aligned box (m).
struct Bounds {
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();

  static Bounds of(const Vec3& a) { return {a, a}; }
  void include(const Vec3& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  void include(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  Bounds grown(double by) const { return {low.array() - by, high.array() + by}; }
  bool contains(const Bounds& other) const {
    return (other.low - low).minCoeff() >= 0.0 && (high - other.high).minCoeff() >= 0.0;
  }
  bool misses(const Bounds& other) const {
    return (low - other.high).maxCoeff() > 0.0 || (other.low - high).maxCoeff() > 0.0;
  }
  double squared_distance(const Vec3& p) const {
    return (low - p).cwiseMax(p - high).cwiseMax(0.0).squaredNorm();
  }
};

// A binary tree over boxes that move together: its shape is chosen once, its boxes follow by refit().
class BoxTree {
 public:
  // Chooses the tree's shape; may allocate.
  void build(std::span<const Bounds> boxes);
  // Follows boxes (as many as at build) that have moved; does not allocate.
  void refit(std::span<const Bounds> boxes);

  bool empty() const { return nodes_.empty(); }
  int size() const { return static_cast<int>(items_.size()); }
  const Bounds& bounds() const { return nodes_.front().box; }

  // Calls visit(item) for every box that meets `region`.
  template <class Visit>
  void in_region(const Bounds& region, Visit visit) const {
    walk([&](const Bounds& box) { return !box.misses(region); }, visit);
  }
  // Calls visit(item) for every box nearer to `p` than the root of `squared_reach`, which `visit` may lower.
  template <class Visit>
  void near_point(const Vec3& p, const double& squared_reach, Visit visit) const {
    walk([&](const Bounds& box) { return box.squared_distance(p) <= squared_reach; }, visit);
  }

 private:
  struct Node {
    Bounds box;
    int right = 0;             // index of the second child, the first one follows its parent; 0 in a leaf
    int first = 0, count = 0;  // items of a leaf
  };
  static constexpr int kLeafItems = 4;
  static constexpr int kDeepest = 64;

  int build(std::span<const Bounds> boxes, int first, int count);

  template <class Meets, class Visit>
  void walk(Meets meets, Visit visit) const {
    if (nodes_.empty()) {
      return;
    }
    int stack[kDeepest];
    int depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const int index = stack[--depth];
      const Node& node = nodes_[static_cast<std::size_t>(index)];
      if (!meets(node.box)) {
        continue;
      }
      if (node.right == 0) {
        for (int i = node.first; i < node.first + node.count; ++i) {
          const int item = items_[static_cast<std::size_t>(i)];
          if (meets(boxes_[static_cast<std::size_t>(item)])) {
            visit(item);
          }
        }
      } else {
        stack[depth++] = node.right;
        stack[depth++] = index + 1;
      }
    }
  }

  std::vector<Node> nodes_;  // parents before children
  std::vector<int> items_;
  std::vector<Bounds> boxes_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
