#include "softpoint/core/shapes.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMaxCells = 4096;         // along one direction of a grid
constexpr double kMaxVertices = 4.0e6;  // of one generated mesh
constexpr int kMaxSubdivisions = 8;     // 655,362 vertices

void check_count(const char* field, int value, int low, int high = kMaxCells) {
  check_range(field, value, low, high);
}

void check_length(std::string_view field, double length) {
  check_range(field, length, kMinMeshSize, kMaxMeshCoordinate);
}

void check_vertex_count(const char* shape, double vertices) {
  if (vertices > kMaxVertices) {
    throw Error(std::string(shape) + ": these counts make " + to_text(vertices) +
                " vertices: permitted is 4 to " + to_text(kMaxVertices));
  }
}

// The quad a, b, c, d, cut along a-c if `even`, else along b-d.
void add_quad(TriangleMesh& mesh, int a, int b, int c, int d, bool even) {
  if (even) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  } else {
    mesh.triangles.push_back({a, b, d});
    mesh.triangles.push_back({b, c, d});
  }
}

// A ring of a surface of revolution: distance from the axis, and height.
struct Ring {
  double radius;
  double z;
};

// The closed surface swept round z by the profile bottom pole, rings, top pole.
TriangleMesh revolve(double bottom, const std::vector<Ring>& rings, double top, int sectors) {
  const int ring_count = static_cast<int>(rings.size());
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(ring_count) * sectors + 2);
  mesh.vertices.emplace_back(0.0, 0.0, bottom);
  for (const Ring& ring : rings) {
    for (int k = 0; k < sectors; ++k) {
      const double angle = 2.0 * kPi * k / sectors;
      mesh.vertices.emplace_back(ring.radius * std::cos(angle), ring.radius * std::sin(angle), ring.z);
    }
  }
  mesh.vertices.emplace_back(0.0, 0.0, top);

  const auto at = [sectors](int ring, int sector) { return 1 + ring * sectors + sector % sectors; };
  const int top_pole = mesh.vertex_count() - 1;
  for (int k = 0; k < sectors; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
  }
  for (int r = 0; r + 1 < ring_count; ++r) {
    for (int k = 0; k < sectors; ++k) {
      add_quad(mesh, at(r, k), at(r, k + 1), at(r + 1, k + 1), at(r + 1, k), (k + r) % 2 == 0);
    }
  }
  for (int k = 0; k < sectors; ++k) {
    mesh.triangles.push_back({top_pole, at(ring_count - 1, k), at(ring_count - 1, k + 1)});
  }
  return mesh;
}

// The icosahedron with vertices at distance 1, poles on the z axis.
TriangleMesh icosahedron() {
  TriangleMesh mesh;
  const double z = 1.0 / std::sqrt(5.0);
  const double r = 2.0 * z;
  mesh.vertices.emplace_back(0.0, 0.0, -1.0);
  for (int k = 0; k < 10; ++k) {  // 1..5 the lower ring, 6..10 the upper one, turned by 36 degrees
    const double angle = kPi * (k < 5 ? 2 * k : 2 * k + 1) / 5.0;
    mesh.vertices.emplace_back(r * std::cos(angle), r * std::sin(angle), k < 5 ? -z : z);
  }
  mesh.vertices.emplace_back(0.0, 0.0, 1.0);
  for (int k = 0; k < 5; ++k) {
    const int low = 1 + k, low_next = 1 + (k + 1) % 5, high = 6 + k, high_next = 6 + (k + 1) % 5;
    mesh.triangles.push_back({0, low_next, low});
    mesh.triangles.push_back({low, low_next, high});
    mesh.triangles.push_back({low_next, high_next, high});
    mesh.triangles.push_back({11, high, high_next});
  }
  return mesh;
}

// Every triangle in four, the new vertices pushed out to the unit sphere.
TriangleMesh subdivided(const TriangleMesh& mesh) {
  TriangleMesh result;
  result.vertices = mesh.vertices;
  result.triangles.reserve(mesh.triangles.size() * 4);
  std::unordered_map<std::uint64_t, int> middles;
  middles.reserve(mesh.triangles.size() * 2);
  const auto middle = [&](int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    const std::uint64_t key = (static_cast<std::uint64_t>(low) << 32) | static_cast<std::uint32_t>(high);
    const auto [entry, is_new] = middles.try_emplace(key, result.vertex_count());
    if (is_new) {
      result.vertices.push_back((mesh.vertices[low] + mesh.vertices[high]).normalized());
    }
    return entry->second;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    result.triangles.push_back({a, ab, ca});
    result.triangles.push_back({ab, b, bc});
    result.triangles.push_back({ca, bc, c});
    result.triangles.push_back({ab, bc, ca});
  }
  return result;
}

}  // namespace

TriangleMesh prism(int sides, int stacks, int cap_rings, double radius, double length, PrismRadius meaning) {
  check_count("prism sides", sides, 3);
  check_count("prism stacks", stacks, 1);
  check_count("prism cap_rings", cap_rings, 1);
  check_length("prism radius", radius);
  check_length("prism length", length);
  check_vertex_count("prism", static_cast<double>(sides) * (stacks + 2.0 * cap_rings - 1.0) + 2.0);
  // Area of the n-gon with circumscribed radius R: n R^2 sin(2 pi/n) / 2.
  const double rim = meaning == PrismRadius::kEqualArea
                         ? radius * std::sqrt(2.0 * kPi / (sides * std::sin(2.0 * kPi / sides)))
                         : radius;
  const double half = 0.5 * length;
  std::vector<Ring> rings;
  for (int k = 1; k < cap_rings; ++k) {
    rings.push_back({rim * k / cap_rings, -half});
  }
  for (int k = 0; k <= stacks; ++k) {
    rings.push_back({rim, length * k / stacks - half});
  }
  for (int k = cap_rings - 1; k >= 1; --k) {
    rings.push_back({rim * k / cap_rings, half});
  }
  return revolve(-half, rings, half, sides);
}

TriangleMesh uv_sphere(double radius, int sectors, int rings) {
  check_length("uv_sphere radius", radius);
  check_count("uv_sphere sectors", sectors, 3);
  check_count("uv_sphere rings", rings, 1);
  check_vertex_count("uv_sphere", static_cast<double>(sectors) * rings + 2.0);
  std::vector<Ring> profile;
  for (int k = 1; k <= rings; ++k) {
    const double polar = kPi * k / (rings + 1);
    profile.push_back({radius * std::sin(polar), -radius * std::cos(polar)});
  }
  return revolve(-radius, profile, radius, sectors);
}

TriangleMesh capsule(double radius, double length, int sectors, int stacks, int rings) {
  check_length("capsule radius", radius);
  check_length("capsule length", length);
  check_count("capsule sectors", sectors, 3);
  check_count("capsule stacks", stacks, 1);
  check_count("capsule rings", rings, 1);
  check_vertex_count("capsule", static_cast<double>(sectors) * (2.0 * rings + stacks - 1.0) + 2.0);
  const double half = 0.5 * length;
  std::vector<Ring> profile;
  for (int k = 1; k < rings; ++k) {
    const double polar = 0.5 * kPi * k / rings;
    profile.push_back({radius * std::sin(polar), -half - radius * std::cos(polar)});
  }
  for (int k = 0; k <= stacks; ++k) {
    profile.push_back({radius, length * k / stacks - half});
  }
  for (int k = rings - 1; k >= 1; --k) {
    const double polar = 0.5 * kPi * k / rings;
    profile.push_back({radius * std::sin(polar), half + radius * std::cos(polar)});
  }
  return revolve(-half - radius, profile, half + radius, sectors);
}

TriangleMesh sphere(double radius, int subdivisions) {
  check_length("sphere radius", radius);
  check_count("sphere subdivisions", subdivisions, 0, kMaxSubdivisions);
  TriangleMesh mesh = icosahedron();
  for (int k = 0; k < subdivisions; ++k) {
    mesh = subdivided(mesh);
  }
  for (Vec3& x : mesh.vertices) {
    x *= radius;
  }
  return mesh;
}

TriangleMesh hollow_sphere(double outer_radius, double inner_radius, int subdivisions) {
  check_length("hollow_sphere outer_radius", outer_radius);
  check_length("hollow_sphere inner_radius", inner_radius);
  check_count("hollow_sphere subdivisions", subdivisions, 0, kMaxSubdivisions);
  if (inner_radius >= outer_radius) {
    throw Error("hollow_sphere inner_radius = " + to_text(inner_radius) +
                ": permitted is less than outer_radius = " + to_text(outer_radius));
  }
  return merged(sphere(outer_radius, subdivisions), flipped(sphere(inner_radius, subdivisions)));
}

TriangleMesh square_grid(int nx, int ny, double width, double height) {
  check_count("square_grid nx", nx, 1);
  check_count("square_grid ny", ny, 1);
  check_length("square_grid width", width);
  check_length("square_grid height", height);
  check_vertex_count("square_grid", (nx + 1.0) * (ny + 1.0));
  TriangleMesh mesh;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      mesh.vertices.emplace_back(width * i / nx - 0.5 * width, height * j / ny - 0.5 * height, 0.0);
    }
  }
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i;
      add_quad(mesh, a, a + 1, a + nx + 2, a + nx + 1, (i + j) % 2 == 0);
    }
  }
  return mesh;
}

TriangleMesh box_grid(int nx, int ny, int nz, const Vec3& size) {
  const std::array<int, 3> cells{nx, ny, nz};
  const std::array<const char*, 3> axes{"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    check_count((std::string("box_grid n") + axes[k]).c_str(), cells[k], 1);
    check_length(std::string("box_grid size ") + axes[k], size[k]);
  }
  check_vertex_count("box_grid", 2.0 * (1.0 * nx * ny + 1.0 * ny * nz + 1.0 * nz * nx) + 2.0);
  TriangleMesh mesh;
  std::map<std::array<int, 3>, int> index_of;
  const auto vertex = [&](const std::array<int, 3>& grid) {
    const auto [entry, is_new] = index_of.try_emplace(grid, mesh.vertex_count());
    if (is_new) {
      Vec3 x;
      for (int k = 0; k < 3; ++k) {
        x[k] = size[k] * grid[k] / cells[k] - 0.5 * size[k];
      }
      mesh.vertices.push_back(x);
    }
    return entry->second;
  };
  // Face by face: u x v points along +axis; on the low side the quad is turned over.
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      for (int j = 0; j < cells[v]; ++j) {
        for (int i = 0; i < cells[u]; ++i) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> grid{};
            grid[axis] = high ? cells[axis] : 0;
            grid[u] = i + di;
            grid[v] = j + dj;
            return vertex(grid);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          const bool even = (i + j) % 2 == 0;
          if (high) {
            add_quad(mesh, a, b, c, d, even);
          } else {
            add_quad(mesh, a, d, c, b, even);
          }
        }
      }
    }
  }
  return mesh;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
