#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "triangle_mesh_topology.h"

namespace softpoint::inline SOFTPOINT_ABI::mesh_check {
namespace {

void check_indices(const TriangleMesh& mesh, const std::string& name) {
  if (mesh.vertices.empty() || mesh.triangles.empty()) {
    throw Error(name + ": has " + std::to_string(mesh.vertices.size()) + " vertices and " +
                std::to_string(mesh.triangles.size()) + " triangles: permitted is at least 3 and 1");
  }
  std::vector<bool> used(mesh.vertices.size(), false);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    for (const int v : corners) {
      if (v < 0 || v >= mesh.vertex_count()) {
        throw Error(name + ": " + triangle_text(mesh, t) + " names vertex " + std::to_string(v) +
                    ": permitted is 0 to " + std::to_string(mesh.vertex_count() - 1));
      }
      used[v] = true;
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      throw Error(name + ": " + triangle_text(mesh, t) + " has a corner twice; remove triangle " +
                  std::to_string(t));
    }
  }
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.vertices[v].allFinite() || mesh.vertices[v].cwiseAbs().maxCoeff() > kMaxMeshCoordinate) {
      throw Error(name + ": vertex " + std::to_string(v) + " is at " + to_text(mesh.vertices[v]) +
                  ": permitted are finite coordinates up to " + to_text(kMaxMeshCoordinate) + " m");
    }
  }
  const auto unused = std::find(used.begin(), used.end(), false);
  if (unused != used.end()) {
    const auto v = std::to_string(unused - used.begin());
    throw Error(name + ": vertex " + v + " belongs to no triangle; remove vertex " + v);
  }
}

double bounding_diagonal(const TriangleMesh& mesh) {
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).norm();
}

void check_distinct_vertices(const TriangleMesh& mesh, const std::string& name) {
  const double diagonal = bounding_diagonal(mesh);
  if (!(diagonal > kMinMeshSize)) {
    throw Error(name + ": is " + to_text(diagonal) + " m across: permitted is more than " +
                to_text(kMinMeshSize) + " m; scale it up");
  }
  const double tolerance = kMinVertexDistance * diagonal;
  const Vec3 origin = mesh.vertices.front();
  // Cells that share a key by chance only cost time.
  const auto key = [](const std::array<std::int64_t, 3>& cell) {
    std::uint64_t hash = 0;
    for (const std::int64_t c : cell) {
      hash = (hash ^ static_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 29;
    }
    return hash;
  };
  std::unordered_multimap<std::uint64_t, int> grid;
  grid.reserve(mesh.vertices.size());
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const Vec3 scaled = (mesh.vertices[v] - origin) / tolerance;
    // Cells are two tolerances a side, so along each axis a coincident vertex lies in the own cell or in
    // the one on the nearer side.
    std::array<std::int64_t, 3> cell{}, side{};
    for (int k = 0; k < 3; ++k) {
      const double position = 0.5 * scaled[k];
      cell[k] = static_cast<std::int64_t>(std::floor(position));
      side[k] = position - std::floor(position) < 0.5 ? -1 : 1;
    }
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::int64_t, 3> near = cell;
      for (int k = 0; k < 3; ++k) {
        near[k] += (corner >> k) & 1 ? side[k] : 0;
      }
      const auto [first, last] = grid.equal_range(key(near));
      for (auto entry = first; entry != last; ++entry) {
        const double distance = (mesh.vertices[v] - mesh.vertices[entry->second]).norm();
        if (distance < tolerance) {
          throw Error(name + ": vertices " + std::to_string(entry->second) + " and " + std::to_string(v) +
                      " are " + to_text(distance) + " m apart: permitted is at least " + to_text(tolerance) +
                      " m; weld vertices " + std::to_string(entry->second) + " and " + std::to_string(v) +
                      ", or move them apart");
        }
      }
    }
    grid.emplace(key(cell), v);
  }
}

void check_triangle_shapes(const TriangleMesh& mesh, const std::string& name) {
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    std::array<double, 3> lengths{};  // edge k runs from corner k to the next
    for (int k = 0; k < 3; ++k) {
      lengths[k] = (mesh.vertices[corners[(k + 1) % 3]] - mesh.vertices[corners[k]]).norm();
    }
    const auto longest = std::max_element(lengths.begin(), lengths.end()) - lengths.begin();
    const auto shortest = std::min_element(lengths.begin(), lengths.end()) - lengths.begin();
    const double height = 2.0 * triangle_area(mesh, t) / lengths[longest];
    if (height >= kMinTriangleHeight * lengths[longest]) {
      continue;
    }
    // A needle has two corners together; a cap has one corner on the opposite edge.
    const int a = corners[shortest], b = corners[(shortest + 1) % 3];
    const int from = corners[longest], to = corners[(longest + 1) % 3], apex = corners[(longest + 2) % 3];
    const bool needle = lengths[shortest] < 1e-3 * lengths[longest];
    throw Error(name + ": " + triangle_text(mesh, t) + " is degenerate, " + to_text(height) +
                " m high over " + to_text(lengths[longest]) + " m: permitted is a height of at least " +
                to_text(kMinTriangleHeight) + " of the longest edge; " +
                (needle ? "weld vertices " + std::to_string(a) + " and " + std::to_string(b) + ", " +
                              to_text(lengths[shortest]) + " m apart"
                        : "split edge " + std::to_string(from) + "-" + std::to_string(to) + " at vertex " +
                              std::to_string(apex) + " and remove triangle " + std::to_string(t)));
  }
}

}  // namespace

std::string triangle_text(const TriangleMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return "triangle " + std::to_string(triangle) + " (" + std::to_string(t[0]) + ", " + std::to_string(t[1]) +
         ", " + std::to_string(t[2]) + ")";
}

void check_elements(const TriangleMesh& mesh, const std::string& name) {
  check_indices(mesh, name);
  check_distinct_vertices(mesh, name);
  check_triangle_shapes(mesh, name);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::mesh_check
