#include "smooth_mesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

// One side of one triangle: corner `corner` (3 t + k) and the next corner round, keyed by the vertices.
struct HalfEdge {
  std::uint32_t low, high;  // vertices
  std::uint32_t corner_low, corner_high;
};

bool within_limits(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kMaxMeshCoordinate; }

// Disjoint sets of corners; those of one set share a normal.
class CornerSets {
 public:
  explicit CornerSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

std::vector<HalfEdge> sorted_half_edges(std::span<const Triangle> triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t next = (k + 1) % 3;
      HalfEdge edge{static_cast<std::uint32_t>(triangles[t][k]),
                    static_cast<std::uint32_t>(triangles[t][next]), 3 * t + k, 3 * t + next};
      if (edge.low > edge.high) {
        std::swap(edge.low, edge.high);
        std::swap(edge.corner_low, edge.corner_high);
      }
      edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.corner_low) < std::tie(b.low, b.high, b.corner_low);
  });
  return edges;
}

}  // namespace

SmoothMesh::SmoothMesh(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                       double crease_degrees)
    : vertex_count_(vertices.size()) {
  check_range("mesh crease_degrees", crease_degrees, 0.0, 180.0);
  if (triangles.empty()) throw Error("mesh triangles = 0: permitted is at least one");
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!within_limits(vertices[i])) {
      check_range("mesh vertex " + std::to_string(i), vertices[i], -kMaxMeshCoordinate, kMaxMeshCoordinate);
    }
  }
  std::vector<Vec3> face_normals(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const int v : triangles[t]) {
      if (v < 0 || static_cast<std::size_t>(v) >= vertices.size()) {
        check_index("mesh triangle " + std::to_string(t) + " vertex", v,
                    static_cast<long long>(vertices.size()));
      }
    }
    const Vec3& a = vertices[static_cast<std::size_t>(triangles[t][0])];
    face_normals[t] = (vertices[static_cast<std::size_t>(triangles[t][1])] - a)
                          .cross(vertices[static_cast<std::size_t>(triangles[t][2])] - a)
                          .normalized();
  }

  const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
  const double smallest_cosine = std::cos(crease_degrees * 3.14159265358979323846 / 180.0);
  CornerSets corners(3 * triangles.size());
  std::vector<std::array<std::uint32_t, 2>> edge_corners;
  for (std::size_t e = 0; e < half_edges.size(); ++e) {
    const HalfEdge& edge = half_edges[e];
    if (e == 0 || half_edges[e - 1].low != edge.low || half_edges[e - 1].high != edge.high) {
      edge_corners.push_back({edge.corner_low, edge.corner_high});
      continue;
    }
    const HalfEdge& previous = half_edges[e - 1];
    if (face_normals[edge.corner_low / 3].dot(face_normals[previous.corner_low / 3]) >= smallest_cosine) {
      corners.unite(edge.corner_low, previous.corner_low);
      corners.unite(edge.corner_high, previous.corner_high);
    }
  }

  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> copy_of_root(3 * triangles.size(), kNone);
  indices_.resize(3 * triangles.size());
  for (std::uint32_t corner = 0; corner < indices_.size(); ++corner) {
    std::uint32_t& copy = copy_of_root[corners.root(corner)];
    if (copy == kNone) {
      copy = static_cast<std::uint32_t>(source_.size());
      source_.push_back(static_cast<std::uint32_t>(triangles[corner / 3][corner % 3]));
    }
    indices_[corner] = copy;
  }
  edges_.reserve(edge_corners.size());
  for (const auto& [a, b] : edge_corners) edges_.push_back({indices_[a], indices_[b]});
  data_.resize(source_.size() * kFloatsPerVertex);
  normals_.resize(source_.size());
  move(vertices);
}

void SmoothMesh::move(std::span<const Vec3> vertices) {
  if (vertices.size() != vertex_count_) {
    throw Error("mesh vertices = " + std::to_string(vertices.size()) + ": permitted is the first count, " +
                std::to_string(vertex_count_));
  }
  std::fill(normals_.begin(), normals_.end(), Vec3::Zero());
  for (std::size_t i = 0; i < indices_.size(); i += 3) {
    const Vec3& a = vertices[source_[indices_[i]]];
    // Twice the area times the unit normal: large faces weigh more.
    const Vec3 normal =
        (vertices[source_[indices_[i + 1]]] - a).cross(vertices[source_[indices_[i + 2]]] - a);
    for (std::size_t k = 0; k < 3; ++k) normals_[indices_[i + k]] += normal;
  }
  Vec3 low = vertices[source_[0]], high = low;
  finite_ = true;
  for (std::size_t i = 0; i < source_.size(); ++i) {
    const Vec3& p = vertices[source_[i]];
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    finite_ = finite_ && within_limits(p);
    const double length = normals_[i].norm();
    const Vec3 n = length > 0 ? Vec3(normals_[i] / length) : Vec3(0, 0, 0);
    float* out = data_.data() + kFloatsPerVertex * i;
    for (int c = 0; c < 3; ++c) {
      out[c] = static_cast<float>(p[c]);
      out[3 + c] = static_cast<float>(n[c]);
    }
  }
  bounds_.center = 0.5 * (low + high);
  const Vec3 half = 0.5 * (high - low);
  for (int c = 0; c < 3; ++c) bounds_.half[static_cast<std::size_t>(c)] = Vec3::Unit(c) * half[c];
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
