#include "softpoint/cloth/pattern.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

void check_count(const char* field, int value) { check_range(field, value, 2, kMaxClothPoints); }

void add_spring(ClothPattern& pattern, int a, int b, double stiffness, SpringKind kind) {
  if (stiffness == 0) return;
  const double rest = (pattern.points[b] - pattern.points[a]).norm();
  pattern.springs.push_back({std::min(a, b), std::max(a, b), rest, stiffness, kind});
}

// Three points in a row: curvature |x0 - 2 x1 + x2| / d^2 over a strip of width w and length d.
void add_row_bend(ClothPattern& pattern, int a, int b, int c, double bending, double spacing, double width) {
  BendElement bend;
  bend.point[0] = a, bend.point[1] = b, bend.point[2] = c, bend.point[3] = c;
  bend.weight[0] = 1, bend.weight[1] = -2, bend.weight[2] = 1;
  bend.stiffness = bending * width / (spacing * spacing * spacing);
  pattern.bends.push_back(bend);
}

}  // namespace

ClothPattern square_pattern(int columns, int rows, double width, double depth, const Fabric& fabric,
                            Lumping lumping) {
  check(fabric);
  check_count("columns", columns);
  check_count("rows", rows);
  check_range("columns * rows", static_cast<double>(columns) * rows, 4, kMaxClothPoints);
  check_range("width", width, kMinMeshSize, kMaxMeshCoordinate);
  check_range("depth", depth, kMinMeshSize, kMaxMeshCoordinate);

  ClothPattern out;
  out.columns = columns;
  out.rows = rows;
  const double dx = width / (columns - 1), dy = depth / (rows - 1);
  out.spacing = std::min(dx, dy);
  const auto index = [columns](int i, int j) { return j * columns + i; };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) out.points.push_back({i * dx - width / 2, j * dy - depth / 2, 0});
  }
  for (int j = 0; j + 1 < rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = index(i, j), b = index(i + 1, j), c = index(i + 1, j + 1), d = index(i, j + 1);
      if ((i + j) % 2 == 0) {
        out.faces.push_back({a, b, d});
        out.faces.push_back({b, c, d});
      } else {
        out.faces.push_back({a, b, c});
        out.faces.push_back({a, c, d});
      }
    }
  }
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int at = index(i, j);
      if (i + 1 < columns) add_spring(out, at, index(i + 1, j), fabric.warp_stiffness, SpringKind::kWarp);
      if (j + 1 < rows) add_spring(out, at, index(i, j + 1), fabric.weft_stiffness, SpringKind::kWeft);
      if (i + 1 < columns && j + 1 < rows) {
        add_spring(out, at, index(i + 1, j + 1), fabric.shear_stiffness, SpringKind::kShear);
        add_spring(out, index(i + 1, j), index(i, j + 1), fabric.shear_stiffness, SpringKind::kShear);
      }
      if (fabric.bending_stiffness == 0) continue;
      if (i > 0 && i + 1 < columns) {
        const double strip = j == 0 || j + 1 == rows ? dy / 2 : dy;
        add_row_bend(out, index(i - 1, j), at, index(i + 1, j), fabric.bending_stiffness, dx, strip);
      }
      if (j > 0 && j + 1 < rows) {
        const double strip = i == 0 || i + 1 == columns ? dx / 2 : dx;
        add_row_bend(out, index(i, j - 1), at, index(i, j + 1), fabric.bending_stiffness, dy, strip);
      }
    }
  }
  const double mass = fabric.area_density * width * depth;
  out.masses.assign(out.points.size(), mass / static_cast<double>(out.points.size()));
  if (lumping == Lumping::kArea) {
    const std::vector<double> areas = vertex_areas({out.points, out.faces});
    for (std::size_t i = 0; i < areas.size(); ++i) out.masses[i] = fabric.area_density * areas[i];
  }
  return out;
}

void check(const ClothPattern& pattern, const std::string& name) {
  const int n = pattern.point_count();
  check_range(name + ".points", n, 1, kMaxClothPoints);
  for (const Vec3& point : pattern.points) {
    check_range(name + ".points", point, -kMaxMeshCoordinate, kMaxMeshCoordinate);
  }
  if (static_cast<int>(pattern.masses.size()) != n) {
    throw Error(name + ".masses has " + std::to_string(pattern.masses.size()) + " entries for " +
                std::to_string(n) + " points");
  }
  for (double mass : pattern.masses) check_range(name + ".masses", mass, kMinPointMass, kMaxPointMass);
  for (const Triangle& face : pattern.faces) {
    for (int point : face) check_index(name + ".faces", point, n);
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
      throw Error(name + ".faces has one that names point " + std::to_string(face[0]) + " twice");
    }
  }
  for (const Spring& spring : pattern.springs) {
    check_index(name + ".springs.a", spring.a, n);
    check_index(name + ".springs.b", spring.b, n);
    if (spring.a >= spring.b) throw Error(name + ".springs must have a < b, not " + std::to_string(spring.a));
    check_range(name + ".springs.rest", spring.rest, kMinMeshSize, kMaxMeshCoordinate);
    check_range(name + ".springs.stiffness", spring.stiffness, 0, kMaxSpringStiffness);
  }
  for (const BendElement& bend : pattern.bends) {
    for (int point : bend.point) check_index(name + ".bends.point", point, n);
    for (double weight : bend.weight) check_finite(name + ".bends.weight", weight);
    check_range(name + ".bends.stiffness", bend.stiffness, 0, 1e15);
  }
  check_positive(name + ".spacing", pattern.spacing);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
