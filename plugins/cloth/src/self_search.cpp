// Which points, faces and edges of a cloth are near each other.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "self_contact.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Pairs of faces a face that a search looks at at most; what is left out is counted (Counts::dropped).
constexpr int kMostFacePairs = 96;
// Two faces give at most nine pairs of edges and six of points and faces.
constexpr std::size_t kPairsOfFaces = 15;

}  // namespace

void SelfContactPass::search(std::span<const Vec3> positions) {
  ++counts.searches;
  travel_ = 0;
  pairs_.clear();
  // Once and for all, but not for cloth that does not meet itself.
  pairs_.reserve(most_pairs_);
  meetings_.reserve(most_pairs_);
  most_face_pairs_ = kMostFacePairs * static_cast<int>(patches_.faces().size());
  patches_.measure(positions, 0.5 * reach_);
  counts.patch_pairs = patches_.near_faces(positions, reach_, [&](int face, int other) {
    if (--most_face_pairs_ < 0 || pairs_.size() + kPairsOfFaces > most_pairs_) {
      ++counts.dropped;
      return;
    }
    consider(face, other, positions);
    consider(other, face, positions);
  });
  std::copy(positions.begin(), positions.end(), searched_at_.begin());
  known_ = true;
  counts.pairs = static_cast<int>(pairs_.size());
}

// Points that `face` owns against `other`; its edges against those of `other` (each pair of edges once: the
// caller comes with both orders).
void SelfContactPass::consider(int face, int other, std::span<const Vec3> positions) {
  const SelfPatches::Owned& mine = patches_.owned(face);
  const Triangle& there = patches_.faces()[static_cast<std::size_t>(other)];
  const double reach = reach_;
  const auto at = [&](int v) -> const Vec3& { return positions[static_cast<std::size_t>(v)]; };
  for (const int p : mine.points) {
    if (p < 0 || p == there[0] || p == there[1] || p == there[2]) {
      continue;
    }
    // Outside the face's box by more than `reach`?
    const Vec3 low = at(there[0]).cwiseMin(at(there[1])).cwiseMin(at(there[2])),
               high = at(there[0]).cwiseMax(at(there[1])).cwiseMax(at(there[2]));
    if ((low - at(p)).cwiseMax(at(p) - high).maxCoeff() > reach) {
      continue;
    }
    const Vec3 normal = (at(there[1]) - at(there[0])).cross(at(there[2]) - at(there[0]));
    const double area = normal.norm();
    const double height = area > 0.0 ? normal.dot(at(p) - at(there[0])) / area : 0.0;
    if (std::abs(height) <= reach) {
      pairs_.push_back({{p, there[0], there[1], there[2]}, false, 0});
    }
  }
  if (face > other) {
    return;
  }
  const SelfPatches::Owned& others = patches_.owned(other);
  for (const int e : mine.edges) {
    for (const int g : others.edges) {
      if (e < 0 || g < 0) {
        continue;
      }
      const auto [a, b] = patches_.edges()[static_cast<std::size_t>(e)];
      const auto [c, d] = patches_.edges()[static_cast<std::size_t>(g)];
      if (a == c || a == d || b == c || b == d) {
        continue;
      }
      const Vec3 low = at(a).cwiseMin(at(b)), high = at(a).cwiseMax(at(b));
      const Vec3 other_low = at(c).cwiseMin(at(d)), other_high = at(c).cwiseMax(at(d));
      if ((low - other_high).cwiseMax(other_low - high).maxCoeff() > reach) {
        continue;
      }
      pairs_.push_back({{a, b, c, d}, true, 0});
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
