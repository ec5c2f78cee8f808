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

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
