#include "box_tree.h"

#include <algorithm>
#include <numeric>

namespace softpoint::inline SOFTPOINT_ABI {

void BoxTree::build(std::span<const Bounds> boxes) {
  nodes_.clear();
  boxes_.assign(boxes.begin(), boxes.end());
  items_.resize(boxes.size());
  std::iota(items_.begin(), items_.end(), 0);
  if (!boxes.empty()) {
    build(boxes, 0, static_cast<int>(boxes.size()));
  }
}

// Halves by number along the longest side: depth is the logarithm of the count whatever the boxes are.
int BoxTree::build(std::span<const Bounds> boxes, int first, int count) {
  const auto index = nodes_.size();
  nodes_.emplace_back();
  const auto begin = items_.begin() + first;
  Bounds all = boxes[static_cast<std::size_t>(*begin)];
  Bounds middles = Bounds::of(all.low + all.high);
  for (auto item = begin; item != begin + count; ++item) {
    const Bounds& box = boxes[static_cast<std::size_t>(*item)];
    all.include(box);
    middles.include(box.low + box.high);
  }
  nodes_[index].box = all;
  if (count <= kLeafItems) {
    nodes_[index].first = first;
    nodes_[index].count = count;
    return static_cast<int>(index);
  }
  int axis = 0;
  (middles.high - middles.low).maxCoeff(&axis);
  const auto middle = [&](int item) {
    const Bounds& box = boxes[static_cast<std::size_t>(item)];
    return box.low[axis] + box.high[axis];
  };
  std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) {
    const double ma = middle(a), mb = middle(b);
    return ma != mb ? ma < mb : a < b;
  });
  build(boxes, first, count / 2);
  nodes_[index].right = build(boxes, first + count / 2, count - count / 2);
  return static_cast<int>(index);
}

void BoxTree::refit(std::span<const Bounds> boxes) {
  std::copy(boxes.begin(), boxes.end(), boxes_.begin());
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    if (node.right == 0) {
      node.box = boxes_[static_cast<std::size_t>(items_[static_cast<std::size_t>(node.first)])];
      for (int k = 1; k < node.count; ++k) {
        node.box.include(boxes_[static_cast<std::size_t>(items_[static_cast<std::size_t>(node.first + k)])]);
      }
    } else {
      node.box = nodes_[i + 1].box;
      node.box.include(nodes_[static_cast<std::size_t>(node.right)].box);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
