#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "softpoint/cloth/pattern.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

struct EdgeSides {
  double weight = 0;  // stiffness times squared length, J
  int faces[2] = {-1, -1};
  int opposite[2] = {-1, -1};  // points across
};

double cotangent(const Vec3& at, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - at, v = c - at;
  return u.dot(v) / u.cross(v).norm();
}

// How the energy of a triangle's membrane is shared by its edges (equation (18) of doc/solver.md): parts that
// sum to 1, not negative, whose directions are as isotropic as three can be. Entry k belongs to the edge
// across corner k. The fourth harmonic of the directions weighs most: the second one cancels between
// neighbours.
std::array<double, 3> edge_parts(const Vec3& p0, const Vec3& p1, const Vec3& p2) {
  // By cotangents a uniform strain is in balance at every point; right angles would leave their hypotenuse
  // nothing.
  const double cot[3] = {cotangent(p0, p1, p2), cotangent(p1, p2, p0), cotangent(p2, p0, p1)};
  if (std::min({cot[0], cot[1], cot[2]}) > 0.1) {
    const double twice = 2 * (p1 - p0).cross(p2 - p0).norm();
    return {cot[0] * (p2 - p1).squaredNorm() / twice, cot[1] * (p0 - p2).squaredNorm() / twice,
            cot[2] * (p1 - p0).squaredNorm() / twice};
  }
  const Vec3 along = (p1 - p0).normalized();
  const Vec3 across = (p2 - p0 - along * along.dot(p2 - p0)).normalized();
  const Vec3 edges[3] = {p2 - p1, p0 - p2, p1 - p0};
  constexpr double kSecond = 0.3, kSum = 3;
  double rows[5][3];
  for (int k = 0; k < 3; ++k) {
    const double angle = std::atan2(edges[k].dot(across), edges[k].dot(along));
    rows[0][k] = kSecond * std::cos(2 * angle);
    rows[1][k] = kSecond * std::sin(2 * angle);
    rows[2][k] = std::cos(4 * angle);
    rows[3][k] = std::sin(4 * angle);
    rows[4][k] = kSum;
  }
  // Least squares without negative parts, one part at a time.
  std::array<double, 3> part = {1. / 3, 1. / 3, 1. / 3};
  for (int sweep = 0; sweep < 100; ++sweep) {
    for (int k = 0; k < 3; ++k) {
      double slope = 0, square = 0;
      for (int r = 0; r < 5; ++r) {
        double misfit = r == 4 ? -kSum : 0;
        for (int j = 0; j < 3; ++j) misfit += rows[r][j] * part[j];
        slope += rows[r][k] * misfit;
        square += rows[r][k] * rows[r][k];
      }
      part[k] = std::max(0.0, part[k] - slope / square);
    }
  }
  const double sum = part[0] + part[1] + part[2];
  for (double& p : part) p /= sum;
  return part;
}

// Bending across an edge (a, b) with points c and d on its sides: the curvature along the normal of the edge.
BendElement edge_bend(const std::vector<Vec3>& x, int a, int b, int c, int d, double bending) {
  const double ac = cotangent(x[a], x[b], x[c]), ad = cotangent(x[a], x[b], x[d]);
  const double bc = cotangent(x[b], x[a], x[c]), bd = cotangent(x[b], x[a], x[d]);
  const double area =
      0.5 * ((x[b] - x[a]).cross(x[c] - x[a]).norm() + (x[b] - x[a]).cross(x[d] - x[a]).norm());
  BendElement bend;
  bend.point[0] = a, bend.point[1] = b, bend.point[2] = c, bend.point[3] = d;
  bend.weight[0] = bc + bd;
  bend.weight[1] = ac + ad;
  bend.weight[2] = -(ac + bc);
  bend.weight[3] = -(ad + bd);
  bend.stiffness = bending / area;
  return bend;
}

}  // namespace

ClothPattern mesh_pattern(const TriangleMesh& mesh, const Fabric& fabric) {
  check(fabric);
  check_surface(mesh, "mesh");
  check_range("mesh.vertices", mesh.vertex_count(), 3, kMaxClothPoints);
  if (fabric.warp_stiffness != fabric.weft_stiffness) {
    throw Error("fabric.weft_stiffness = " + to_text(fabric.weft_stiffness) +
                "; a mesh has no warp and weft: permitted is fabric.warp_stiffness = " +
                to_text(fabric.warp_stiffness));
  }
  ClothPattern out;
  out.points = mesh.vertices;
  out.faces = mesh.triangles;
  const double membrane = 4.0 / 3.0 * fabric.warp_stiffness;  // E h
  std::map<std::pair<int, int>, EdgeSides> edges;
  for (int f = 0; f < mesh.triangle_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const auto& x = mesh.vertices;
    const std::array<double, 3> part = edge_parts(x[t[0]], x[t[1]], x[t[2]]);
    const double energy = 3 * membrane * triangle_area(mesh, f);
    for (int k = 0; k < 3; ++k) {
      const int a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      EdgeSides& edge = edges[{std::min(a, b), std::max(a, b)}];
      edge.weight += energy * part[k];
      const int side = edge.faces[0] < 0 ? 0 : 1;
      edge.faces[side] = f;
      edge.opposite[side] = t[k];
    }
  }
  out.spacing = HUGE_VAL;
  for (const auto& [ends, edge] : edges) {
    const auto [a, b] = ends;
    const double rest = (out.points[b] - out.points[a]).norm();
    out.springs.push_back({a, b, rest, edge.weight / (rest * rest), SpringKind::kWarp});
    out.spacing = std::min(out.spacing, rest);
    if (fabric.bending_stiffness == 0 || edge.faces[1] < 0) continue;
    out.bends.push_back(
        edge_bend(out.points, a, b, edge.opposite[0], edge.opposite[1], fabric.bending_stiffness));
  }
  const std::vector<double> areas = vertex_areas(mesh);
  for (double area : areas) out.masses.push_back(fabric.area_density * area);
  return out;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
