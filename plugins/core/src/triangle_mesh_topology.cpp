#include "triangle_mesh_topology.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::mesh_check {
namespace {

// One side of a triangle, from its corner `corner` to the next.
struct Side {
  int low, high;  // vertices of the edge
  int triangle;
  int corner;
  bool rising;  // runs from `low` to `high`
};

std::string edge_text(const Side& side) {
  return "edge " + std::to_string(side.low) + "-" + std::to_string(side.high);
}

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides;
  sides.reserve(mesh.triangles.size() * 3);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), t, k, a < b});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
    return std::tie(x.low, x.high, x.triangle) < std::tie(y.low, y.high, y.triangle);
  });
  return sides;
}

// Sets of elements that grow together; the root of a set is its smallest element.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int x) {
    while (parent_[x] != x) {
      x = parent_[x] = parent_[parent_[x]];
    }
    return x;
  }
  void join(int x, int y) {
    const auto [low, high] = std::minmax({root(x), root(y)});
    parent_[high] = low;
  }

 private:
  std::vector<int> parent_;
};

// A pair of triangles across an edge; `agree` if they turn the same way.
struct Pair {
  int first, second;
  bool agree;
  const Side* side;
};

// Name the triangles to flip: walk over each shell, turning triangles to match the first; the fewer
// ones are the wrong ones.
[[noreturn]] void refuse_turning(const TriangleMesh& mesh, const std::string& name,
                                 const std::vector<Pair>& pairs) {
  std::vector<std::vector<const Pair*>> around(mesh.triangles.size());
  for (const Pair& pair : pairs) {
    around[pair.first].push_back(&pair);
    around[pair.second].push_back(&pair);
  }
  std::vector<int> sense(mesh.triangles.size(), 0);
  for (int seed = 0; seed < mesh.triangle_count(); ++seed) {
    if (sense[seed] != 0) {
      continue;
    }
    sense[seed] = 1;
    std::vector<int> shell{seed};
    for (std::size_t next = 0; next < shell.size(); ++next) {
      const int t = shell[next];
      for (const Pair* pair : around[t]) {
        const int other = pair->first == t ? pair->second : pair->first;
        const int wanted = pair->agree ? sense[t] : -sense[t];
        if (sense[other] == 0) {
          sense[other] = wanted;
          shell.push_back(other);
        } else if (sense[other] != wanted) {
          throw Error(name + ": the surface has one side only (seen at " + edge_text(*pair->side) +
                      ", triangles " + std::to_string(pair->first) + " and " + std::to_string(pair->second) +
                      "); no flipping of triangles can orient it, cut it or rebuild it there");
        }
      }
    }
    const auto turned = std::count_if(shell.begin(), shell.end(), [&](int t) { return sense[t] < 0; });
    const int wrong = 2 * turned > static_cast<long>(shell.size()) ? 1 : -1;
    std::vector<int> flips;
    std::copy_if(shell.begin(), shell.end(), std::back_inserter(flips),
                 [&](int t) { return sense[t] == wrong; });
    if (flips.empty()) {
      continue;
    }
    std::sort(flips.begin(), flips.end());
    const int t = flips.front();
    std::string message = name + ": " + triangle_text(mesh, t) +
                          " turns against its neighbours; flip triangle " + std::to_string(t);
    if (flips.size() > 1) {
      message +=
          " and " + std::to_string(flips.size() - 1) + " more (next: " + std::to_string(flips[1]) + ")";
    }
    throw Error(message);
  }
  throw Error(name + ": triangles turn against each other");
}

std::vector<Pair> check_edges(const TriangleMesh& mesh, const std::string& name, bool open,
                              const std::vector<Side>& sides, int& boundary_edges) {
  std::vector<Pair> pairs;
  pairs.reserve(sides.size() / 2);
  bool all_agree = true;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) {
      ++end;
    }
    const Side& side = sides[i];
    if (end - i > 2) {
      throw Error(name + ": " + edge_text(side) + " is shared by " + std::to_string(end - i) +
                  " triangles (" + std::to_string(side.triangle) + ", " +
                  std::to_string(sides[i + 1].triangle) + ", " + std::to_string(sides[i + 2].triangle) +
                  (end - i > 3 ? ", ..." : "") + "): permitted is 2; remove the superfluous triangles, or " +
                  "give each pair an edge of its own");
    }
    if (end - i == 1) {
      ++boundary_edges;
      if (!open) {
        throw Error(name + ": " + edge_text(side) + " of triangle " + std::to_string(side.triangle) +
                    " is open: every edge of a closed surface has two triangles; fill the hole along it");
      }
    } else {
      const bool agree = side.rising != sides[i + 1].rising;
      all_agree = all_agree && agree;
      pairs.push_back({side.triangle, sides[i + 1].triangle, agree, &side});
    }
    i = end;
  }
  if (!all_agree) {
    refuse_turning(mesh, name, pairs);
  }
  return pairs;
}

// The triangles round a vertex must hang together by edges through that vertex.
void check_fans(const TriangleMesh& mesh, const std::string& name, const std::vector<Side>& sides) {
  DisjointSets corners(mesh.triangles.size() * 3);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const Side &a = sides[i], &b = sides[i + 1];
    if (a.low == b.low && a.high == b.high) {
      // The triangles run along the edge in opposite directions: start of one meets end of the other.
      corners.join(3 * a.triangle + a.corner, 3 * b.triangle + (b.corner + 1) % 3);
      corners.join(3 * a.triangle + (a.corner + 1) % 3, 3 * b.triangle + b.corner);
    }
  }
  std::vector<int> fan_of(mesh.vertices.size(), -1);
  for (int corner = 0; corner < 3 * mesh.triangle_count(); ++corner) {
    const int v = mesh.triangles[corner / 3][corner % 3];
    const int fan = corners.root(corner);
    if (fan_of[v] < 0) {
      fan_of[v] = fan;
    } else if (fan_of[v] != fan) {
      throw Error(name + ": vertex " + std::to_string(v) +
                  " joins two fans of triangles, one with triangle " + std::to_string(fan_of[v] / 3) +
                  " and one with triangle " + std::to_string(fan / 3) +
                  ": permitted is one; give each fan a vertex of its own and move them apart");
    }
  }
}

}  // namespace

Topology check_topology(const TriangleMesh& mesh, const std::string& name, bool open) {
  const std::vector<Side> sides = sorted_sides(mesh);
  Topology topology;
  const std::vector<Pair> pairs = check_edges(mesh, name, open, sides, topology.boundary_edges);
  check_fans(mesh, name, sides);
  DisjointSets shells(mesh.triangles.size());
  for (const Pair& pair : pairs) {
    shells.join(pair.first, pair.second);
  }
  topology.shell_of.resize(mesh.triangles.size());
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const int root = shells.root(t);  // never larger than t
    topology.shell_of[t] = root == t ? topology.shells++ : topology.shell_of[root];
  }
  return topology;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::mesh_check
