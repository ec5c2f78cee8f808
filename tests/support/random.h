#pragma once

#include <cstdint>

#include "softpoint/core/vec.h"

namespace softpoint {

// A generator of our own: the same numbers with every standard library.
class Random {
 public:
  // The first number of neighbouring starts is much alike, so it is left out.
  explicit Random(std::uint64_t start) : state_(start * 2654435769u + 1) { unit(); }
  double unit() {  // [0, 1)
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * unit(); }
  int below(int count) { return static_cast<int>(unit() * count); }
  Vec3 vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

 private:
  std::uint64_t state_;
};

}  // namespace softpoint
