#pragma once

#include <span>
#include <utility>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Union-find over the integers of a span that its owner keeps. The smallest member stands for its set, so
// that what comes out does not depend on the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(std::span<int> parents) : parents_(parents) {}

  int find(int i) const {
    while (parents_[i] != i) {
      parents_[i] = parents_[parents_[i]];
      i = parents_[i];
    }
    return i;
  }

  void unite(int i, int j) const {
    i = find(i);
    j = find(j);
    if (i > j) std::swap(i, j);
    parents_[j] = i;
  }

 private:
  std::span<int> parents_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
