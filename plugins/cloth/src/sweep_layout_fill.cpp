// The tables of a layout, once each point has its slot.
#include <algorithm>
#include <string>

#include "softpoint/core/error.h"
#include "sweep_layout.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

void SweepLayout::fill(const std::vector<Node>& nodes, bool grid, int stride) {
  point_of.assign(slots, -1);
  for (std::size_t p = 0; p < nodes.size(); ++p) point_of[slot_of[p]] = static_cast<int>(p);
  long bend_at = 0, face_at = 0;
  for (std::size_t c = 0; c < colours.size(); ++c) {
    ColourPlan& plan = colours[c];
    const int end = plan.first + plan.tiles * kTile;
    std::vector<std::pair<int, int>> pairs;
    for (int slot = plan.first; slot < end; ++slot) {
      if (point_of[slot] < 0) continue;
      const Node& node = nodes[point_of[slot]];
      plan.ring = std::max(plan.ring, static_cast<int>(node.links.size()));
      plan.bends = std::max(plan.bends, static_cast<int>(node.bends.size()));
      for (const Corner& corner : node.faces) pairs.push_back({corner.j, corner.k});
    }
    if (plan.ring > kMaxRing || plan.bends > kMaxBendRing) {
      throw Error("pattern: a point has " + std::to_string(std::max(plan.ring, plan.bends)) +
                  " neighbours; permitted: " + std::to_string(kMaxRing));
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    plan.faces = static_cast<int>(pairs.size());
    std::vector<signed char> j, k;
    for (const auto& pair : pairs) j.push_back(static_cast<signed char>(pair.first));
    for (const auto& pair : pairs) k.push_back(static_cast<signed char>(pair.second));
    pairs_.push_back(std::move(j));
    plan.face_j = pairs_.back().data();
    pairs_.push_back(std::move(k));
    plan.face_k = pairs_.back().data();

    plan.spring_at = spring_size, plan.face_at = face_at, plan.bend_at = bend_at;
    spring_size += static_cast<long>(plan.tiles) * plan.ring * 4 * kTile;
    face_at += static_cast<long>(plan.tiles) * plan.faces * kTile;
    bend_at += static_cast<long>(plan.tiles) * plan.bends * kTile;
    spring_of.resize(spring_size / 4, -1);
    face_of.resize(face_at, -1);
    bend_weight.resize(bend_at, 0.0);
    std::vector<int> index(static_cast<std::size_t>(plan.tiles) * plan.ring * kTile);
    std::vector<int> bend_index(static_cast<std::size_t>(plan.tiles) * plan.bends * kTile);
    for (int slot = plan.first; slot < end; ++slot) {
      const int tile = (slot - plan.first) / kTile, lane = (slot - plan.first) % kTile;
      const Node* node = point_of[slot] < 0 ? nullptr : &nodes[point_of[slot]];
      for (int r = 0; r < plan.ring; ++r) {
        const std::size_t at = (static_cast<std::size_t>(tile) * plan.ring + r) * kTile + lane;
        const bool there =
            node != nullptr && r < static_cast<int>(node->links.size()) && node->links[r].to >= 0;
        index[at] = there ? slot_of[node->links[r].to] : slot;
        if (there) spring_of[plan.spring_at / 4 + at] = node->links[r].spring;
      }
      for (int r = 0; r < plan.bends; ++r) {
        const std::size_t at = (static_cast<std::size_t>(tile) * plan.bends + r) * kTile + lane;
        const bool there =
            node != nullptr && r < static_cast<int>(node->bends.size()) && node->bends[r].first >= 0;
        bend_index[at] = there ? slot_of[node->bends[r].first] : slot;
        if (there) bend_weight[plan.bend_at + at] = node->bends[r].second;
      }
      if (node == nullptr) continue;
      for (const Corner& corner : node->faces) {
        const auto found = std::lower_bound(pairs.begin(), pairs.end(), std::pair(corner.j, corner.k));
        const long at = (static_cast<long>(tile) * plan.faces + (found - pairs.begin())) * kTile + lane;
        face_of[plan.face_at + at] = corner.face;
      }
    }
    if (grid) {
      // Colours are one after the other; a step east from an even column stays in the row of the other
      // colour.
      std::vector<int> offset, bend_offset;
      const int column = static_cast<int>(c) % 2, row = static_cast<int>(c) / 2;
      const auto shift = [&](int east, int north) {
        const int e = column + east + 2, n = row + north + 2;  // not negative
        const int other = n % 2 * 2 + e % 2;
        return colours[other].first + (n / 2 - 1) * stride + (e / 2 - 1) - plan.first;
      };
      for (int r = 0; r < 8; ++r) offset.push_back(shift(kEast[r], kNorth[r]));
      for (int r = 0; r < plan.bends; ++r) bend_offset.push_back(shift(kBendEast[r], kBendNorth[r]));
      numbers_.push_back(std::move(offset));
      plan.offset = numbers_.back().data();
      numbers_.push_back(std::move(bend_offset));
      plan.bend_offset = numbers_.back().data();
    } else {
      numbers_.push_back(std::move(index));
      plan.index = numbers_.back().data();
      numbers_.push_back(std::move(bend_index));
      plan.bend_index = numbers_.back().data();
    }
  }
}

void SweepLayout::find_volume_colours(const ClothPattern& pattern) {
  const int count = static_cast<int>(colours.size());
  const auto colour_of = [&](int point) {
    int c = 0;
    while (c + 1 < count && slot_of[point] >= colours[c + 1].first) ++c;
    return c;
  };
  std::vector<int> of(pattern.points.size());
  for (int p = 0; p < pattern.point_count(); ++p) of[p] = colour_of(p);
  for (unsigned set = 1; set < (1u << std::min(count, 8)); ++set) {
    bool once = true;
    for (const Triangle& t : pattern.faces) {
      int corners = 0;
      for (int p : t) corners += (set >> of[p]) & 1u;
      if (!(once = corners == 1)) break;
    }
    if (!once) continue;
    for (int c = 0; c < std::min(count, 8); ++c) {
      if ((set >> c) & 1u) volume_colours.push_back(c);
    }
    return;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
