#include "self_patches.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Quads along the side of a patch of a grid, and as many faces in one of a mesh.
constexpr int kPatchQuads = 5;
constexpr int kPatchFaces = 2 * kPatchQuads * kPatchQuads;
// Normals within this angle of an axis are those of a patch that cannot fold back.
constexpr double kFlatCosine = 0.26;  // 75 degrees

}  // namespace

SelfPatches::SelfPatches(const ClothPattern& pattern) : faces_(pattern.faces) {
  owned_.resize(faces_.size());
  std::vector<char> taken(pattern.points.size(), 0);
  std::map<std::pair<int, int>, int> known;
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = faces_[f][k], b = faces_[f][(k + 1) % 3];
      if (!taken[static_cast<std::size_t>(a)]) {
        taken[static_cast<std::size_t>(a)] = 1;
        owned_[f].points[k] = a;
      }
      const auto [entry, fresh] = known.try_emplace(std::minmax(a, b), static_cast<int>(edges_.size()));
      if (fresh) {
        owned_[f].edges[k] = entry->second;
        edges_.push_back({a, b});
      }
    }
  }
  cut(pattern);
  boxes_.resize(faces_.size());
  normals_.resize(faces_.size());
  boxed_.resize(patches_.size());
  first_.reserve(2 * kPatchFaces);
  second_.reserve(2 * kPatchFaces);
}

void SelfPatches::cut(const ClothPattern& pattern) {
  std::vector<int> patch_of(faces_.size(), -1);
  int count = 0;
  if (pattern.columns > 1) {
    const int across = (pattern.columns - 2) / kPatchQuads + 1;
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      const int corner = *std::min_element(faces_[f].begin(), faces_[f].end());
      int column = pattern.columns;
      for (const int v : faces_[f]) {
        column = std::min(column, v % pattern.columns);
      }
      const int row = corner / pattern.columns;
      patch_of[f] = (row / kPatchQuads) * across + column / kPatchQuads;
      count = std::max(count, patch_of[f] + 1);
    }
  } else {  // grown from face to face
    std::vector<std::vector<int>> round(pattern.points.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      for (const int v : faces_[f]) {
        round[static_cast<std::size_t>(v)].push_back(static_cast<int>(f));
      }
    }
    std::vector<int> queue;
    for (std::size_t seed = 0; seed < faces_.size(); ++seed) {
      if (patch_of[seed] >= 0) {
        continue;
      }
      queue.assign(1, static_cast<int>(seed));
      patch_of[seed] = count;
      for (std::size_t i = 0; i < queue.size(); ++i) {
        for (const int v : faces_[static_cast<std::size_t>(queue[i])]) {
          for (const int next : round[static_cast<std::size_t>(v)]) {
            if (patch_of[static_cast<std::size_t>(next)] < 0 && queue.size() < kPatchFaces) {
              patch_of[static_cast<std::size_t>(next)] = count;
              queue.push_back(next);
            }
          }
        }
      }
      ++count;
    }
  }
  patches_.resize(static_cast<std::size_t>(count));
  std::vector<std::vector<int>> patches_at(pattern.points.size());
  for (std::size_t f = 0; f < faces_.size(); ++f) {
    Patch& patch = patches_[static_cast<std::size_t>(patch_of[f])];
    patch.faces.push_back(static_cast<int>(f));
    for (const int v : faces_[f]) {
      std::vector<int>& at = patches_at[static_cast<std::size_t>(v)];
      if (std::find(at.begin(), at.end(), patch_of[f]) == at.end()) {
        at.push_back(patch_of[f]);
        patch.points.push_back(v);
      }
    }
  }
  neighbours_.assign(patches_.size() * patches_.size(), 0);
  for (const std::vector<int>& at : patches_at) {
    for (const int a : at) {
      for (const int b : at) {
        neighbours_[static_cast<std::size_t>(a) * patches_.size() + static_cast<std::size_t>(b)] = 1;
      }
    }
  }
}

void SelfPatches::measure(std::span<const Vec3> positions, double reach) {
  const auto at = [&](int v) -> const Vec3& { return positions[static_cast<std::size_t>(v)]; };
  for (Patch& patch : patches_) {
    Vec3 low = at(patch.points.front()), high = low;
    for (const int v : patch.points) {
      low = low.cwiseMin(at(v));
      high = high.cwiseMax(at(v));
    }
    for (int k = 0; k < 3; ++k) {
      // A float may be off by an ulp of a large coordinate.
      patch.box.low[k] = std::nextafter(static_cast<float>(low[k] - reach), -1e30f);
      patch.box.high[k] = std::nextafter(static_cast<float>(high[k] + reach), 1e30f);
    }
    Vec3 sum = Vec3::Zero();
    for (const int f : patch.faces) {
      const Triangle& t = faces_[static_cast<std::size_t>(f)];
      sum += (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
    }
    const double length = sum.norm();
    patch.cosine = -1.0;
    if (length > 0.1) {
      patch.axis = sum / length;
      patch.cosine = 1.0;
      for (const int f : patch.faces) {
        const Triangle& t = faces_[static_cast<std::size_t>(f)];
        const Vec3 normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
        patch.cosine = std::min(patch.cosine, patch.axis.dot(normal) / std::max(normal.norm(), 1e-300));
      }
    }
  }
}

bool SelfPatches::may_meet(std::size_t a, std::size_t b) const {
  const Patch &first = patches_[a], &second = patches_[b];
  if (a == b) {
    return first.cosine < kFlatCosine;
  }
  if (!first.box.meets(second.box)) {
    return false;
  }
  if (!touch(a, b) || first.cosine < kFlatCosine || second.cosine < kFlatCosine) {
    return true;
  }
  // The cone round both: half the angle between the axes and the wider of the two.
  const double between = std::acos(std::clamp(first.axis.dot(second.axis), -1.0, 1.0));
  const double wider = std::acos(std::clamp(std::min(first.cosine, second.cosine), -1.0, 1.0));
  return std::cos(std::min(0.5 * between + wider, 3.1)) < kFlatCosine;
}

void SelfPatches::box_faces(std::size_t patch, std::span<const Vec3> positions, double reach) {
  if (boxed_[patch]) {
    return;
  }
  boxed_[patch] = 1;
  const double half = 0.5 * reach;
  for (const int f : patches_[patch].faces) {
    const Triangle& t = faces_[static_cast<std::size_t>(f)];
    const Vec3 &a = positions[static_cast<std::size_t>(t[0])], &b = positions[static_cast<std::size_t>(t[1])],
               &c = positions[static_cast<std::size_t>(t[2])];
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const Vec3 normal = (b - a).cross(c - a).normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      normals_[static_cast<std::size_t>(f)][k] = static_cast<float>(normal[static_cast<Eigen::Index>(k)]);
    }
    Box& box = boxes_[static_cast<std::size_t>(f)];
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::nextafter(static_cast<float>(low[k] - half), -1e30f);
      box.high[k] = std::nextafter(static_cast<float>(high[k] + half), 1e30f);
    }
  }
}

void SelfPatches::pick(std::size_t patch, const Box& region, std::vector<int>& out) const {
  out.clear();
  for (const int f : patches_[patch].faces) {
    if (box_of(f).meets(region)) {
      out.push_back(f);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
