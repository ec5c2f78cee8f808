#include "sweep_layout.h"

#include <algorithm>
#include <map>
#include <string>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Entries of B, the matrix of bending: energy 1/2 x^T B x.
std::vector<std::map<int, double>> bend_matrix(const ClothPattern& pattern) {
  std::vector<std::map<int, double>> rows(pattern.points.size());
  for (const BendElement& bend : pattern.bends) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double entry = bend.stiffness * bend.weight[i] * bend.weight[j];
        if (bend.point[i] != bend.point[j] && entry != 0) rows[bend.point[i]][bend.point[j]] += entry;
      }
    }
  }
  return rows;
}

int round_up(int value, int to) { return (value + to - 1) / to * to; }

// East first, counter-clockwise.
constexpr int kEast[8] = {1, 1, 0, -1, -1, -1, 0, 1};
constexpr int kNorth[8] = {0, 1, 1, 1, 0, -1, -1, -1};
// The neighbours that bending over two cells may reach.
constexpr int kBendEast[12] = {1, 0, -1, 0, 2, 0, -2, 0, 1, -1, -1, 1};
constexpr int kBendNorth[12] = {0, 1, 0, -1, 0, 2, 0, -2, 1, 1, -1, -1};

}  // namespace

SweepLayout::SweepLayout(const ClothPattern& pattern) {
  std::vector<Node> nodes(pattern.points.size());
  const bool grid = pattern.columns > 1 && pattern.rows > 1 && lay_grid(pattern, nodes);
  if (!grid) lay_mesh(pattern, nodes);
  fill(nodes, grid, (pattern.columns + 1) / 2 + 1);
  find_volume_colours(pattern);
}

// Four colours by the parity of column and row; false when something joins points farther apart.
bool SweepLayout::lay_grid(const ClothPattern& pattern, std::vector<Node>& nodes) {
  const int columns = pattern.columns, rows = pattern.rows;
  if (columns * rows != pattern.point_count()) return false;
  const auto direction = [columns](int a, int b) {
    for (int k = 0; k < 8; ++k) {
      if (b % columns - a % columns == kEast[k] && b / columns - a / columns == kNorth[k]) return k;
    }
    return -1;
  };
  for (Node& node : nodes) node.links.assign(8, {-1, -1});
  for (int p = 0; p < pattern.point_count(); ++p) {
    for (int k = 0; k < 8; ++k) {
      const int i = p % columns + kEast[k], j = p / columns + kNorth[k];
      if (i >= 0 && i < columns && j >= 0 && j < rows) nodes[p].links[k].to = j * columns + i;
    }
  }
  for (std::size_t s = 0; s < pattern.springs.size(); ++s) {
    const Spring& spring = pattern.springs[s];
    const int forth = direction(spring.a, spring.b), back = direction(spring.b, spring.a);
    if (forth < 0 || nodes[spring.a].links[forth].spring >= 0) return false;
    nodes[spring.a].links[forth].spring = nodes[spring.b].links[back].spring = static_cast<int>(s);
  }
  for (std::size_t f = 0; f < pattern.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Triangle& t = pattern.faces[f];
      const int j = direction(t[k], t[(k + 1) % 3]), l = direction(t[k], t[(k + 2) % 3]);
      if (j < 0 || l < 0) return false;
      nodes[t[k]].faces.push_back({j, l, static_cast<int>(f)});
    }
  }
  const std::vector<std::map<int, double>> bends = bend_matrix(pattern);
  for (int p = 0; p < pattern.point_count(); ++p) {
    nodes[p].bends.assign(pattern.bends.empty() ? 0 : 12, {-1, 0.0});
    for (const auto& [q, weight] : bends[p]) {
      int found = -1;
      for (int k = 0; k < 12; ++k) {
        if (q % columns - p % columns == kBendEast[k] && q / columns - p / columns == kBendNorth[k])
          found = k;
      }
      if (found < 0) return false;
      nodes[p].bends[found] = {q, weight};
    }
  }

  const int stride = (columns + 1) / 2 + 1, height = (rows + 1) / 2;
  const int guard = round_up(stride + 2, kTile);
  int cursor = guard;
  slot_of.assign(nodes.size(), -1);
  for (int colour = 0; colour < 4; ++colour) {
    ColourPlan plan;
    plan.first = cursor;
    plan.tiles = round_up(stride * height, kTile) / kTile;
    for (int j = colour / 2; j < rows; j += 2) {
      for (int i = colour % 2; i < columns; i += 2) {
        slot_of[j * columns + i] = cursor + j / 2 * stride + i / 2;
      }
    }
    colours.push_back(plan);
    cursor += plan.tiles * kTile + guard;
  }
  slots = cursor;
  return true;
}

// Colours one after the other: each point takes the first that none of its neighbours has, most neighbours
// first.
void SweepLayout::lay_mesh(const ClothPattern& pattern, std::vector<Node>& nodes) {
  const int n = pattern.point_count();
  for (Node& node : nodes) node = {};
  std::vector<std::map<int, int>> next(n);  // per point: face corner after it -> the face
  for (std::size_t f = 0; f < pattern.faces.size(); ++f) {
    const Triangle& t = pattern.faces[f];
    for (int k = 0; k < 3; ++k) {
      if (!next[t[k]].emplace(t[(k + 1) % 3], static_cast<int>(f)).second) {
        throw Error("pattern.faces: two run the same way along the edge of points " + std::to_string(t[k]) +
                    " and " + std::to_string(t[(k + 1) % 3]));
      }
    }
  }
  std::vector<std::multimap<int, int>> springs(n);
  for (std::size_t s = 0; s < pattern.springs.size(); ++s) {
    springs[pattern.springs[s].a].emplace(pattern.springs[s].b, static_cast<int>(s));
    springs[pattern.springs[s].b].emplace(pattern.springs[s].a, static_cast<int>(s));
  }
  for (int p = 0; p < n; ++p) {
    Node& node = nodes[p];
    // Round the point by its faces, each fan from its open end.
    const auto third = [&](int face, int j) {
      const Triangle& t = pattern.faces[face];
      for (int k = 0; k < 3; ++k) {
        if (t[k] == p) return t[(k + 2) % 3];
      }
      return j;
    };
    std::map<int, int> before;
    for (const auto& [j, f] : next[p]) before[third(f, j)] = j;
    std::map<int, int> left = next[p];
    while (!left.empty()) {
      int j = left.begin()->first;
      for (const auto& [from, f] : left) {
        if (before.find(from) == before.end()) {
          j = from;
          break;
        }
      }
      node.links.push_back({j, -1});
      for (auto it = left.find(j); it != left.end(); it = left.find(j)) {
        const int face = it->second;
        left.erase(it);
        j = third(face, j);
        node.links.push_back({j, -1});
        const int at = static_cast<int>(node.links.size());
        node.faces.push_back({at - 2, at - 1, face});
      }
    }
    for (const auto& [q, s] : springs[p]) {
      const auto same = [q = q](const Link& link) { return link.to == q && link.spring < 0; };
      const auto found = std::find_if(node.links.begin(), node.links.end(), same);
      if (found != node.links.end()) {
        found->spring = s;
      } else {
        node.links.push_back({q, s});
      }
    }
  }
  const std::vector<std::map<int, double>> bends = bend_matrix(pattern);
  for (int p = 0; p < n; ++p) nodes[p].bends.assign(bends[p].begin(), bends[p].end());

  std::vector<int> order(n), colour(n, -1);
  for (int p = 0; p < n; ++p) order[p] = p;
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return nodes[a].links.size() > nodes[b].links.size(); });
  int count = 0;
  std::vector<char> taken;
  for (int p : order) {
    taken.assign(count + 1, 0);
    for (const Link& link : nodes[p].links) {
      if (colour[link.to] >= 0) taken[colour[link.to]] = 1;
    }
    for (const auto& bend : nodes[p].bends) {
      if (colour[bend.first] >= 0) taken[colour[bend.first]] = 1;
    }
    colour[p] = static_cast<int>(std::find(taken.begin(), taken.end(), 0) - taken.begin());
    count = std::max(count, colour[p] + 1);
  }
  slot_of.assign(n, -1);
  int cursor = 0;
  for (int c = 0; c < count; ++c) {
    ColourPlan plan;
    plan.first = cursor;
    int members = 0;
    for (int p = 0; p < n; ++p) {
      if (colour[p] == c) slot_of[p] = cursor + members++;
    }
    plan.tiles = round_up(members, kTile) / kTile;
    cursor += plan.tiles * kTile;
    colours.push_back(plan);
  }
  slots = cursor;
}

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
