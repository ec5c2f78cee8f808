// Segments with joining surfaces on ends and sides.
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/character_shapes.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using Grid = std::array<int, 3>;

// A box whose grid is known, while discs are cut into its sides.
class BoxCutter {
 public:
  BoxCutter(const Grid& cells, const Vec3& size)
      : cells_(cells), size_(size), mesh_(box_grid(cells[0], cells[1], cells[2], size)) {
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      Grid at{};
      for (int k = 0; k < 3; ++k) {
        const double share = mesh_.vertices[static_cast<std::size_t>(v)][k] / size[k] + 0.5;
        at[static_cast<std::size_t>(k)] =
            static_cast<int>(std::lround(share * cells[static_cast<std::size_t>(k)]));
      }
      index_[at] = v;
    }
  }

  // All vertices of the low or high z side, its middle first.
  std::vector<int> end(bool high) const {
    const int z = high ? cells_[2] : 0;
    std::vector<int> vertices = {index_.at({cells_[0] / 2, cells_[1] / 2, z})};
    for (int j = 0; j <= cells_[1]; ++j) {
      for (int i = 0; i <= cells_[0]; ++i) {
        const int v = index_.at({i, j, z});
        if (v != vertices.front()) vertices.push_back(v);
      }
    }
    return vertices;
  }

  // Cuts the disc and returns its vertices, the centre first.
  std::vector<int> cut(const BoxPatch& patch, const std::string& name) {
    const bool along_x = patch.side == BoxSide::kLowX || patch.side == BoxSide::kHighX;
    const bool high = patch.side == BoxSide::kHighX || patch.side == BoxSide::kHighY;
    const std::size_t axis = along_x ? 0 : 1, across = 1 - axis, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const int half = patch.cells / 2;
    Grid middle{};
    middle[axis] = high ? cells_[axis] : 0;
    middle[across] = cells_[across] / 2 + patch.across;
    middle[2] = cells_[2] / 2 + patch.along;
    check_patch(patch, name, across, middle);
    const auto vertex = [&](int i, int j) {
      Grid at = middle;
      at[u] += i;
      at[v] += j;
      return index_.at(at);
    };
    const int center = vertex(0, 0);
    std::vector<int> rim;
    const int count = 4 * patch.cells;
    for (int k = 0; k < count; ++k) {
      const auto [i, j] = on_square(k, half);
      rim.push_back(vertex(i, j));
    }
    std::set<int> square;
    for (int j = -half; j <= half; ++j) {
      for (int i = -half; i <= half; ++i) square.insert(vertex(i, j));
    }
    for (const int w : square) {
      if (!taken_.insert(w).second) {
        throw Error(name + " overlaps another patch; permitted are patches that share no vertex");
      }
    }
    std::erase_if(mesh_.triangles, [&](const Triangle& t) {
      return square.contains(t[0]) && square.contains(t[1]) && square.contains(t[2]);
    });
    for (int k = 0; k < count; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / count;
      Vec3& place = mesh_.vertices[static_cast<std::size_t>(rim[static_cast<std::size_t>(k)])];
      place = mesh_.vertices[static_cast<std::size_t>(center)];
      place[static_cast<Eigen::Index>(u)] += patch.radius * std::cos(angle);
      place[static_cast<Eigen::Index>(v)] += patch.radius * std::sin(angle);
      const int a = rim[static_cast<std::size_t>(k)], b = rim[static_cast<std::size_t>((k + 1) % count)];
      mesh_.triangles.push_back(high ? Triangle{center, a, b} : Triangle{center, b, a});
    }
    std::vector<int> disc = {center};
    disc.insert(disc.end(), rim.begin(), rim.end());
    return disc;
  }

  // The mesh without vertices that lost all their triangles.
  SegmentShape finish(std::vector<std::vector<int>> interfaces) {
    std::vector<int> renamed(mesh_.vertices.size(), -1);
    for (const Triangle& t : mesh_.triangles) {
      for (const int v : t) renamed[static_cast<std::size_t>(v)] = 0;
    }
    SegmentShape shape;
    for (std::size_t v = 0; v < renamed.size(); ++v) {
      if (renamed[v] < 0) continue;
      renamed[v] = shape.mesh.vertex_count();
      shape.mesh.vertices.push_back(mesh_.vertices[v]);
    }
    const auto rename = [&](int& v) { v = renamed[static_cast<std::size_t>(v)]; };
    shape.mesh.triangles = mesh_.triangles;
    for (Triangle& t : shape.mesh.triangles) std::for_each(t.begin(), t.end(), rename);
    shape.interfaces = std::move(interfaces);
    for (auto& vertices : shape.interfaces) std::for_each(vertices.begin(), vertices.end(), rename);
    return shape;
  }

 private:
  // The k-th vertex round a square of 2 `half` cells a side, counter-clockwise from the middle of its +u
  // side.
  static std::array<int, 2> on_square(int k, int half) {
    const int side = 2 * half, at = (k + half) % (4 * side);
    const int step = at % side - half;
    switch (at / side) {
      case 0:
        return {half, step};
      case 1:
        return {-step, half};
      case 2:
        return {-half, -step};
      default:
        return {step, -half};
    }
  }

  void check_patch(const BoxPatch& patch, const std::string& name, std::size_t across,
                   const Grid& middle) const {
    check_range(name + ".cells", patch.cells, 2, 1000);
    const int half = patch.cells / 2;
    if (patch.cells % 2 != 0) {
      throw Error(name + ".cells = " + std::to_string(patch.cells) + "; permitted are even numbers");
    }
    for (const std::size_t axis : {across, std::size_t{2}}) {
      const int count = cells_[axis];
      const std::string field = name + (axis == 2 ? ".along" : ".across");
      const int at = middle[axis] - count / 2;
      if (count % 2 != 0 || count < 2 * half + 2) {
        throw Error(name + ": its side has " + std::to_string(count) + " cells along axis " +
                    std::to_string(axis) + "; permitted are even numbers from " +
                    std::to_string(2 * half + 2));
      }
      check_range(field, at, -(count / 2 - half - 1), count / 2 - half - 1);
      const double cell = size_[static_cast<Eigen::Index>(axis)] / count;
      check_range(name + ".radius", patch.radius, 0.25 * half * cell, (half + 0.5) * cell);
    }
  }

  Grid cells_;
  Vec3 size_;
  TriangleMesh mesh_;
  std::map<Grid, int> index_;
  std::set<int> taken_;
};

}  // namespace

SegmentShape prism_shape(int sides, int stacks, double radius, double length) {
  SegmentShape shape;
  shape.mesh = prism(sides, stacks, 1, radius, length);
  // Lower centre, rings upward, upper centre.
  shape.interfaces = {{0}, {shape.mesh.vertex_count() - 1}};
  for (int i = 0; i < sides; ++i) {
    shape.interfaces[0].push_back(1 + i);
    shape.interfaces[1].push_back(1 + sides * stacks + i);
  }
  return shape;
}

SegmentShape box_shape(const std::array<int, 3>& cells, const Vec3& size,
                       const std::vector<BoxPatch>& patches) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (cells[k] % 2 != 0) {
      throw Error("box_shape: cells[" + std::to_string(k) + "] = " + std::to_string(cells[k]) +
                  "; permitted are even numbers: the bone runs through the middle of the ends");
    }
  }
  BoxCutter cutter(cells, size);
  std::vector<std::vector<int>> interfaces = {cutter.end(false), cutter.end(true)};
  for (std::size_t p = 0; p < patches.size(); ++p) {
    interfaces.push_back(cutter.cut(patches[p], "patches[" + std::to_string(p) + "]"));
  }
  return cutter.finish(std::move(interfaces));
}

std::shared_ptr<const SegmentModel> make_segment(const SegmentShape& shape, const Material& material,
                                                 const SegmentSettings& settings) {
  return make_segment_model(shape.mesh, shape.interfaces, material, settings);
}

Mat3 turn_to_axis(const Vec3& axis, double roll) {
  check_finite("turn_to_axis: axis", axis);
  check_finite("turn_to_axis: roll", roll);
  if (!(axis.norm() > 0.0)) {
    throw Error("turn_to_axis: axis = " + to_text(axis) + "; permitted is any length but 0");
  }
  const Vec3 to = axis.normalized();
  Mat3 turn;
  if (to.z() < -1.0 + 1e-12) {
    turn = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
  } else {
    turn = Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), to).toRotationMatrix();
  }
  return turn * Eigen::AngleAxisd(roll, Vec3::UnitZ()).toRotationMatrix();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
