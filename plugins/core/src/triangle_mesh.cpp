#include "softpoint/core/triangle_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cstdint>
#include <unordered_set>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Twice the area along the normal.
Vec3 area_vector(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
}

}  // namespace

Vec3 triangle_normal(const TriangleMesh& mesh, int triangle) {
  return area_vector(mesh, mesh.triangles[triangle]).normalized();
}

double triangle_area(const TriangleMesh& mesh, int triangle) {
  return 0.5 * area_vector(mesh, mesh.triangles[triangle]).norm();
}

std::vector<double> vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (const Triangle& t : mesh.triangles) {
    const double third = area_vector(mesh, t).norm() / 6.0;
    for (const int v : t) {
      areas[v] += third;
    }
  }
  return areas;
}

std::vector<std::array<int, 2>> unique_edges(const TriangleMesh& mesh) {
  std::vector<std::array<int, 2>> edges;
  std::unordered_set<std::uint64_t> seen;
  seen.reserve(mesh.triangles.size() * 2);
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
      if (seen.insert(key).second) {
        edges.push_back({low, high});
      }
    }
  }
  return edges;
}

double signed_volume(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) {
    return 0.0;
  }
  // Relative to a vertex of the mesh, so that a body far from the origin loses no digits.
  const Vec3 o = mesh.vertices.front();
  double six_volumes = 0.0;
  for (const Triangle& t : mesh.triangles) {
    six_volumes += (mesh.vertices[t[0]] - o).dot((mesh.vertices[t[1]] - o).cross(mesh.vertices[t[2]] - o));
  }
  return six_volumes / 6.0;
}

double surface_area(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    area += 0.5 * area_vector(mesh, t).norm();
  }
  return area;
}

TriangleMesh transformed(const TriangleMesh& mesh, const Mat3& linear, const Vec3& offset) {
  TriangleMesh result = linear.determinant() < 0.0 ? flipped(mesh) : mesh;
  for (Vec3& x : result.vertices) {
    x = linear * x + offset;
  }
  return result;
}

TriangleMesh flipped(const TriangleMesh& mesh) {
  TriangleMesh result = mesh;
  for (Triangle& t : result.triangles) {
    std::swap(t[1], t[2]);
  }
  return result;
}

TriangleMesh merged(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh result = a;
  result.vertices.insert(result.vertices.end(), b.vertices.begin(), b.vertices.end());
  const int shift = a.vertex_count();
  for (const Triangle& t : b.triangles) {
    result.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  }
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
