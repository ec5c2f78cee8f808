#pragma once

#include <cstddef>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

// Anderson's acceleration of a fixed-point iteration x <- x + g(x): of the last few changes the combination
// that would have cancelled g in the least squares. Allocates at construction only.
class Anderson {
 public:
  explicit Anderson(std::size_t size);
  void restart() { count_ = taken_ = 0; }
  // Moves x, at which the iteration would go by g.
  void move(std::vector<double>& x, const std::vector<double>& g);

 private:
  static constexpr int kDepth = 5;
  std::vector<double> dx_[kDepth], dg_[kDepth], last_x_, last_g_;
  int count_ = 0, taken_ = 0;  // differences kept; moves
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
