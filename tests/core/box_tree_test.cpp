// The tree against a plain scan of all boxes.
#include "box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace softpoint {
namespace {

std::vector<Bounds> random_boxes(int count, unsigned seed) {
  std::vector<Bounds> boxes;
  unsigned state = seed;
  const auto next = [&] {
    state = state * 1664525u + 1013904223u;
    return (state >> 8) * 0x1p-24;
  };
  for (int i = 0; i < count; ++i) {
    const Vec3 low(next(), next(), next());
    const Vec3 size(0.1 * next(), 0.1 * next(), 0.0);
    boxes.push_back({low, low + size});
  }
  return boxes;
}

void expect_same_as_scan(const BoxTree& tree, const std::vector<Bounds>& boxes, const Bounds& region) {
  std::vector<int> found, expected;
  tree.in_region(region, [&](int item) { found.push_back(item); });
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].misses(region)) expected.push_back(static_cast<int>(i));
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
}

TEST(BoxTree, FindsWhatAScanFinds) {
  for (const int count : {0, 1, 4, 5, 37, 1000}) {
    std::vector<Bounds> boxes = random_boxes(count, 7);
    BoxTree tree;
    tree.build(boxes);
    EXPECT_EQ(tree.size(), count);
    for (unsigned k = 0; k < 20; ++k) {
      expect_same_as_scan(tree, boxes, random_boxes(1, 100 + k)[0].grown(0.1));
    }
    boxes = random_boxes(count, 8);
    tree.refit(boxes);
    for (unsigned k = 0; k < 20; ++k) {
      expect_same_as_scan(tree, boxes, random_boxes(1, 200 + k)[0].grown(0.1));
    }
  }
}

TEST(BoxTree, FindsTheNearest) {
  const std::vector<Bounds> boxes = random_boxes(500, 3);
  BoxTree tree;
  tree.build(boxes);
  int visited = 0;
  for (unsigned k = 0; k < 50; ++k) {
    const Vec3 p = random_boxes(1, 300 + k)[0].low * 1.5;
    double best = std::numeric_limits<double>::infinity(), expected = best;
    tree.near_point(p, best, [&](int item) {
      ++visited;
      best = std::min(best, boxes[static_cast<std::size_t>(item)].squared_distance(p));
    });
    for (const Bounds& box : boxes) expected = std::min(expected, box.squared_distance(p));
    EXPECT_EQ(best, expected);
  }
  EXPECT_LT(visited, 50 * 250) << "the tree must spare most of the boxes";
}

TEST(BoxTree, ManyEqualBoxesStayShallow) {
  const std::vector<Bounds> boxes(10000, Bounds::of(Vec3(1, 2, 3)));
  BoxTree tree;
  tree.build(boxes);
  int found = 0;
  tree.in_region(Bounds::of(Vec3(1, 2, 3)), [&](int) { ++found; });
  EXPECT_EQ(found, 10000);
}

}  // namespace
}  // namespace softpoint
