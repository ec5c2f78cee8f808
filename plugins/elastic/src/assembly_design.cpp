#include "softpoint/elastic/assembly_design.h"

#include <Eigen/LU>

#include <set>

#include "placed_design.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

int AssemblyDesign::add_row(std::string name, std::shared_ptr<const SegmentModel> segment, int count,
                            const Vec3& root, const Mat3& rotation, const BoneSettings& bone) {
  check_range("add_row: count", count, 1, 100000);
  parts.push_back({std::move(name),
                   std::vector<std::shared_ptr<const SegmentModel>>(static_cast<std::size_t>(count), segment),
                   root, rotation, bone});
  return static_cast<int>(parts.size()) - 1;
}

namespace {

void check_part(const PartDesign& part, const std::string& name) {
  if (part.segments.empty()) {
    throw Error(name + ".segments is empty; permitted are one or more");
  }
  for (std::size_t s = 0; s < part.segments.size(); ++s) {
    const std::string segment = name + ".segments[" + std::to_string(s) + "]";
    if (part.segments[s] == nullptr) {
      throw Error(segment + " is null; permitted is one of make_segment_model");
    }
    if (part.segments[s]->interfaces.size() < 2) {
      throw Error(segment + " has one interface; permitted are two or more, root and tip first");
    }
  }
  check_range(name + ".root", part.root, -kMaxPosition, kMaxPosition);
  check_range(name + ".rotation, distance from a rotation matrix",
              (part.rotation.transpose() * part.rotation - Mat3::Identity()).norm() +
                  std::abs(part.rotation.determinant() - 1.0),
              0.0, 1e-6);
  check_range(name + ".bone.length_stiffness", part.bone.length_stiffness, 0.0, 1e15);
  check_range(name + ".bone.angle_stiffness", part.bone.angle_stiffness, 0.0, 1e15);
  check_range(name + ".bone.mass", part.bone.mass, 0.0, 1e9);
  check_range(name + ".bone.damping", part.bone.damping, 0.0, 1e12);
}

std::string name_of(const AssemblyDesign& design, int part) {
  const std::string& name = design.parts[static_cast<std::size_t>(part)].name;
  return "parts[" + std::to_string(part) + "]" + (name.empty() ? "" : " '" + name + "'");
}

}  // namespace

void check(const AssemblyDesign& design) {
  if (design.parts.empty()) {
    throw Error("assembly: parts is empty; permitted are one or more");
  }
  for (std::size_t p = 0; p < design.parts.size(); ++p) {
    check_part(design.parts[p], name_of(design, static_cast<int>(p)));
  }
  std::set<std::array<int, 2>> ends;
  std::set<std::array<int, 3>> patches;
  for (std::size_t j = 0; j < design.joins.size(); ++j) {
    const Join& join = design.joins[j];
    const std::string name = "joins[" + std::to_string(j) + "]";
    check_index(name + ".end.part", join.end.part, static_cast<long long>(design.parts.size()));
    check_index(name + ".patch.part", join.patch.part, static_cast<long long>(design.parts.size()));
    const PartDesign& part = design.parts[static_cast<std::size_t>(join.patch.part)];
    check_index(name + ".patch.segment", join.patch.segment, static_cast<long long>(part.segments.size()));
    const SegmentModel& model = *part.segments[static_cast<std::size_t>(join.patch.segment)];
    check_range(name + ".patch.interface", join.patch.interface, 2,
                static_cast<double>(model.interfaces.size()) - 1.0);
    if (join.end.part == join.patch.part) {
      throw Error(name + ": joins " + name_of(design, join.end.part) +
                  " to itself; permitted are two different parts");
    }
    if (!ends.insert({join.end.part, join.end.tip ? 1 : 0}).second ||
        !patches.insert({join.patch.part, join.patch.segment, join.patch.interface}).second) {
      throw Error(name + ": its end or patch is joined already; permitted is one join for each");
    }
  }
  place(design);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
