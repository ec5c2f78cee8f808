#include "draw_list.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace softpoint::inline SOFTPOINT_ABI::picture {

void DrawList::sort() {
  order_.resize(draws_.size());
  std::iota(order_.begin(), order_.end(), 0U);
  std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
    return std::tuple(draws_[a].two_sided, draws_[a].mesh, a) <
           std::tuple(draws_[b].two_sided, draws_[b].mesh, b);
  });
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
