#pragma once

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <memory>
#include <numbers>
#include <tuple>
#include <vector>

#include "softpoint/core/shapes.h"
#include "softpoint/elastic/assembly.h"
#include "support/temporary_folder.h"

// Segments, chains and a branched figure for the tests of assemblies and characters.
namespace softpoint {

using SegmentPointer = std::shared_ptr<const elastic::SegmentModel>;

// Boundary stiffness is assembled once a program.
inline elastic::SegmentSettings with_shared_cache() {
  static TemporaryFolder folder;
  elastic::SegmentSettings settings;
  settings.cache.folder = folder.path().string();
  return settings;
}

// The paper's cylinder, 82 vertices with four stacks.
inline SegmentPointer cylinder_segment(double young = 1e5, int stacks = 4, double length = 1.0,
                                       double radius = 0.5, double density = 1000.0) {
  static std::map<std::tuple<double, int, double, double, double>, SegmentPointer> known;
  SegmentPointer& model = known[{young, stacks, length, radius, density}];
  if (!model) {
    model =
        elastic::make_prism_segment(16, stacks, radius, length, {young, 0.3, density}, with_shared_cache());
  }
  return model;
}

// Vertices for which `inside` holds, the one nearest to their middle first.
template <class Inside>
std::vector<int> interface_of(const TriangleMesh& mesh, Inside&& inside) {
  std::vector<int> found;
  Vec3 middle = Vec3::Zero();
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (!inside(mesh.vertices[static_cast<std::size_t>(v)])) continue;
    found.push_back(v);
    middle += mesh.vertices[static_cast<std::size_t>(v)];
  }
  middle /= static_cast<double>(found.size());
  const auto distance = [&](int v) { return (mesh.vertices[static_cast<std::size_t>(v)] - middle).norm(); };
  std::iter_swap(found.begin(), std::min_element(found.begin(), found.end(),
                                                 [&](int a, int b) { return distance(a) < distance(b); }));
  return found;
}

// 1 x 1 x 1.5 m, z upward; interfaces: bottom, top, patches of 0.5 x 0.5 m on the sides at +x and -x.
inline SegmentPointer torso_segment(double young = 1e5) {
  static std::map<double, SegmentPointer> known;
  SegmentPointer& model = known[young];
  if (!model) {
    const TriangleMesh mesh = box_grid(4, 4, 6, Vec3(1.0, 1.0, 1.5));
    const auto on = [&](int axis, double at, double half) {
      return interface_of(mesh, [=](const Vec3& x) {
        for (int k = 0; k < 3; ++k) {
          if (k == axis ? std::abs(x[k] - at) > 1e-9 : std::abs(x[k]) > half + 1e-9) return false;
        }
        return true;
      });
    };
    model = elastic::make_segment_model(
        mesh, {on(2, -0.75, 1.0), on(2, 0.75, 1.0), on(0, 0.5, 0.25), on(0, -0.5, 0.25)},
        {young, 0.3, 1000.0}, with_shared_cache());
  }
  return model;
}

// 0.5 x 0.5 x 1 m along z, caps that fit the torso's patches.
inline SegmentPointer limb_segment(double young = 1e5) {
  static std::map<double, SegmentPointer> known;
  SegmentPointer& model = known[young];
  if (!model) {
    const TriangleMesh mesh = box_grid(2, 2, 4, Vec3(0.5, 0.5, 1.0));
    const auto cap = [&](double z) {
      return interface_of(mesh, [=](const Vec3& x) { return std::abs(x.z() - z) < 1e-9; });
    };
    model =
        elastic::make_segment_model(mesh, {cap(-0.5), cap(0.5)}, {young, 0.3, 1000.0}, with_shared_cache());
  }
  return model;
}

inline Mat3 turned_about(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

inline constexpr double kPi = std::numbers::pi;
// Ends of the first part.
inline constexpr elastic::PartEnd kRoot = {0, false}, kTip = {0, true};

// `count` cylinders in a row along z from the origin.
inline elastic::AssemblyDesign chain_of(int count, const SegmentPointer& segment = cylinder_segment(),
                                        const elastic::BoneSettings& bone = {}) {
  elastic::AssemblyDesign design;
  design.add_row("chain", segment, count, Vec3::Zero(), Mat3::Identity(), bone);
  return design;
}

// Part 0 a torso along z, parts 1 and 2 limbs of two segments that leave its sides along x and -x.
inline elastic::AssemblyDesign branched_figure(double young = 1e5, const elastic::BoneSettings& bone = {}) {
  elastic::AssemblyDesign design;
  design.add_row("torso", torso_segment(young), 1, Vec3(0, 0, -0.75), Mat3::Identity(), bone);
  design.add_row("right", limb_segment(young), 2, Vec3(0.5, 0, 0), turned_about(Vec3::UnitY(), 0.5 * kPi),
                 bone);
  design.add_row("left", limb_segment(young), 2, Vec3(-0.5, 0, 0), turned_about(Vec3::UnitY(), -0.5 * kPi),
                 bone);
  design.joins = {{{1, false}, {0, 0, 2}}, {{2, false}, {0, 0, 3}}};
  return design;
}

}  // namespace softpoint
