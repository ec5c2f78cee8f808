// Where a cloth passes through itself, by trying: the judge of what self_contact.cpp prevents.
#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

#include "cloth_state.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Whether the segment from..to passes through the triangle (double-sided).
bool cuts(const Vec3& from, const Vec3& to, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 d = to - from, e1 = b - a, e2 = c - a;
  const Vec3 q = d.cross(e2);
  const double det = e1.dot(q);
  if (det == 0.0) {
    return false;
  }
  const Vec3 s = from - a;
  const double u = s.dot(q) / det;
  const Vec3 r = s.cross(e1);
  const double v = d.dot(r) / det, t = e2.dot(r) / det;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 && t <= 1.0;
}

}  // namespace

int Cloth::count_intersections() const {
  struct Box {
    Vec3 low, high;
  };
  std::vector<Box> boxes(triangles_.size());
  const auto at = [&](int v) -> const Vec3& { return positions_[static_cast<std::size_t>(v)]; };
  for (std::size_t f = 0; f < boxes.size(); ++f) {
    const Triangle& t = triangles_[f];
    boxes[f] = {at(t[0]).cwiseMin(at(t[1])).cwiseMin(at(t[2])),
                at(t[0]).cwiseMax(at(t[1])).cwiseMax(at(t[2]))};
  }
  std::vector<std::size_t> order(boxes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return boxes[a].low.x() < boxes[b].low.x(); });
  int count = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t f = order[i];
    const Triangle& t = triangles_[f];
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].low.x() <= boxes[f].high.x(); ++j) {
      const std::size_t g = order[j];
      const Triangle& o = triangles_[g];
      if ((boxes[f].low - boxes[g].high).maxCoeff() > 0.0 ||
          (boxes[g].low - boxes[f].high).maxCoeff() > 0.0) {
        continue;
      }
      const bool share =
          std::any_of(t.begin(), t.end(), [&](int v) { return v == o[0] || v == o[1] || v == o[2]; });
      if (share) {
        continue;
      }
      bool cut = false;
      for (std::size_t k = 0; k < 3 && !cut; ++k) {
        cut = cuts(at(t[k]), at(t[(k + 1) % 3]), at(o[0]), at(o[1]), at(o[2])) ||
              cuts(at(o[k]), at(o[(k + 1) % 3]), at(t[0]), at(t[1]), at(t[2]));
      }
      count += cut;
    }
  }
  return count;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
