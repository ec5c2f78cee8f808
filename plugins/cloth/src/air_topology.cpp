#include "air_topology.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

#include "disjoint_sets.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

struct HalfEdge {
  int low, high;  // points
  int face;
  bool forward;  // the face runs from low to high
};

std::vector<HalfEdge> half_edges_by_points(std::span<const Triangle> faces) {
  std::vector<HalfEdge> halves;
  halves.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), static_cast<int>(f), a < b});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& x, const HalfEdge& y) {
    return std::array{x.low, x.high, x.face} < std::array{y.low, y.high, y.face};
  });
  return halves;
}

}  // namespace

AirTopology make_air_topology(std::span<const Vec3> rest, std::span<const Triangle> faces) {
  AirTopology topology;
  topology.points = static_cast<int>(rest.size());
  topology.faces.assign(faces.begin(), faces.end());
  topology.point_areas.assign(rest.size(), 0.0);
  for (const Triangle& face : faces) {
    for (const int point : face) check_index("face", point, topology.points);
    const Vec3 &a = rest[face[0]], &b = rest[face[1]], &c = rest[face[2]];
    const double area = (b - a).cross(c - a).norm() / 2;
    topology.face_areas.push_back(area);
    for (const int point : face) topology.point_areas[point] += area / 3;
  }

  const std::vector<HalfEdge> halves = half_edges_by_points(faces);
  for (std::size_t i = 0; i < halves.size();) {
    const HalfEdge& first = halves[i];
    std::size_t end = i + 1;
    while (end < halves.size() && halves[end].low == first.low && halves[end].high == first.high) ++end;
    if (end - i > 2 || (end - i == 2 && halves[i + 1].forward == first.forward)) {
      throw Error("faces: the edge between points " + std::to_string(first.low) + " and " +
                  std::to_string(first.high) + " has " + std::to_string(end - i) +
                  " faces; permitted: one, or two that run along it in opposite directions");
    }
    topology.edges.push_back({first.forward ? first.low : first.high, first.forward ? first.high : first.low,
                              first.face, end - i == 2 ? halves[i + 1].face : -1,
                              (rest[first.low] - rest[first.high]).norm()});
    i = end;
  }
  std::stable_sort(topology.edges.begin(), topology.edges.end(),
                   [](const AirTopology::Edge& x, const AirTopology::Edge& y) { return x.face < y.face; });

  std::vector<int> parents(faces.size());
  std::iota(parents.begin(), parents.end(), 0);
  const DisjointSets sets(parents);
  for (const AirTopology::Edge& edge : topology.edges) {
    if (edge.other >= 0) sets.unite(edge.face, edge.other);
  }
  topology.shells.assign(faces.size(), -1);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const int root = sets.find(static_cast<int>(f));
    topology.shells[f] = root == static_cast<int>(f) ? topology.shell_count++ : topology.shells[root];
  }
  std::vector<char> bordered(topology.shell_count, 0);
  for (const AirTopology::Edge& edge : topology.edges) {
    if (edge.other < 0) bordered[topology.shells[edge.face]] = 1;
  }
  for (std::size_t f = 0; f < faces.size(); ++f) topology.closed.push_back(!bordered[topology.shells[f]]);
  return topology;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
