#include "placed_design.h"

#include <algorithm>
#include <numeric>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Joining surfaces must meet within this fraction of their size.
constexpr double kPairing = 1e-5;

std::vector<Vec3> points_of(const PlacedSegment& segment, int interface) {
  std::vector<Vec3> points;
  for (const int v : segment.model->interfaces[static_cast<std::size_t>(interface)]) {
    points.push_back(segment.rotation * segment.model->mesh.vertices[static_cast<std::size_t>(v)] +
                     segment.origin);
  }
  return points;
}

double size_of(const std::vector<Vec3>& points) {
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, (p - points.front()).norm());
  return size;
}

// For each point of `a` the one of `b` in its place.
std::vector<int> pairing(const std::vector<Vec3>& a, const std::vector<Vec3>& b, const std::string& name) {
  if (a.size() != b.size()) {
    throw Error(name + ": joining surfaces of " + std::to_string(a.size()) + " and " +
                std::to_string(b.size()) + " vertices; permitted are equal numbers, paired one to one");
  }
  const double limit = kPairing * std::max(size_of(a), size_of(b));
  std::vector<int> order;
  std::vector<char> used(b.size(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < b.size(); ++k) {
      if ((b[k] - a[i]).norm() < (b[nearest] - a[i]).norm()) nearest = k;
    }
    const double distance = (b[nearest] - a[i]).norm();
    if (distance > limit || used[nearest] != 0) {
      throw Error(name + ": vertex " + std::to_string(i) + " of the joining surface is " + to_text(distance) +
                  " m from the nearest unpaired one of the other; permitted is " + to_text(limit) +
                  " m, one to one");
    }
    used[nearest] = 1;
    order.push_back(static_cast<int>(nearest));
  }
  return order;
}

std::vector<int> counting(std::size_t count) {
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

class Placing {
 public:
  explicit Placing(const AssemblyDesign& design) : design_(design) {}

  PlacedDesign run() {
    for (std::size_t p = 0; p < design_.parts.size(); ++p) place_part(static_cast<int>(p));
    for (const Join& join : design_.joins) apply(join);
    drop_unused();
    find_groups();
    return std::move(out_);
  }

 private:
  int add_joint(int segment, int interface) {
    PlacedSegment& s = out_.segments[static_cast<std::size_t>(segment)];
    PlacedJoint joint;
    joint.rest = points_of(s, interface);
    joint.interfaces.push_back({segment, interface});
    joint.order.push_back(counting(joint.rest.size()));
    s.joint[static_cast<std::size_t>(interface)] = static_cast<int>(out_.joints.size());
    out_.joints.push_back(std::move(joint));
    return static_cast<int>(out_.joints.size()) - 1;
  }

  void meet(int joint, int segment, int interface, const std::string& name) {
    PlacedJoint& j = out_.joints[static_cast<std::size_t>(joint)];
    PlacedSegment& s = out_.segments[static_cast<std::size_t>(segment)];
    j.order.push_back(pairing(points_of(s, interface), j.rest, name));
    j.interfaces.push_back({segment, interface});
    s.joint[static_cast<std::size_t>(interface)] = joint;
  }

  void place_part(int p) {
    const PartDesign& part = design_.parts[static_cast<std::size_t>(p)];
    out_.first_segment.push_back(static_cast<int>(out_.segments.size()));
    out_.part_joints.emplace_back();
    Vec3 at = part.root;
    for (std::size_t k = 0; k < part.segments.size(); ++k) {
      const SegmentModel& model = *part.segments[k];
      const auto vertex = [&](std::size_t interface) -> const Vec3& {
        return model.mesh.vertices[static_cast<std::size_t>(model.interfaces[interface].front())];
      };
      PlacedSegment segment;
      segment.part = p;
      segment.index = static_cast<int>(k);
      segment.model = &model;
      segment.rotation = part.rotation;
      segment.origin = at - part.rotation * vertex(0);
      segment.joint.assign(model.interfaces.size(), -1);
      at = part.rotation * vertex(1) + segment.origin;
      out_.segments.push_back(std::move(segment));
      const int index = static_cast<int>(out_.segments.size()) - 1;
      std::vector<int>& joints = out_.part_joints.back();
      if (k == 0) {
        joints.push_back(add_joint(index, 0));
      } else {
        meet(joints.back(), index, 0, "parts[" + std::to_string(p) + "].segments[" + std::to_string(k) + "]");
      }
      joints.push_back(add_joint(index, 1));
      for (std::size_t i = 2; i < model.interfaces.size(); ++i) add_joint(index, static_cast<int>(i));
    }
  }

  // The patch gives its points to the joint of the end.
  void apply(const Join& join) {
    const auto& joints = out_.part_joints[static_cast<std::size_t>(join.end.part)];
    const int segment = out_.first_segment[static_cast<std::size_t>(join.patch.part)] + join.patch.segment;
    const int joint = join.end.tip ? joints.back() : joints.front();
    const int old = out_.segments[static_cast<std::size_t>(segment)]
                        .joint[static_cast<std::size_t>(join.patch.interface)];
    meet(joint, segment, join.patch.interface, "joins");
    out_.joints[static_cast<std::size_t>(old)].interfaces.clear();
  }

  void drop_unused() {
    std::vector<int> renamed(out_.joints.size(), -1);
    std::vector<PlacedJoint> kept;
    for (std::size_t j = 0; j < out_.joints.size(); ++j) {
      if (out_.joints[j].interfaces.empty()) continue;
      renamed[j] = static_cast<int>(kept.size());
      kept.push_back(std::move(out_.joints[j]));
    }
    out_.joints = std::move(kept);
    for (PlacedSegment& s : out_.segments) {
      for (int& j : s.joint) j = renamed[static_cast<std::size_t>(j)];
    }
    for (std::vector<int>& part : out_.part_joints) {
      for (int& j : part) j = renamed[static_cast<std::size_t>(j)];
    }
  }

  void find_groups() {
    std::vector<int> root(out_.joints.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int j) {
      while (root[static_cast<std::size_t>(j)] != j) j = root[static_cast<std::size_t>(j)];
      return j;
    };
    for (const PlacedSegment& s : out_.segments) {
      for (const int j : s.joint) root[static_cast<std::size_t>(find(j))] = find(s.joint.front());
    }
    std::vector<int> number(out_.joints.size(), -1);
    for (std::size_t j = 0; j < out_.joints.size(); ++j) {
      int& n = number[static_cast<std::size_t>(find(static_cast<int>(j)))];
      if (n < 0) n = out_.groups++;
      out_.joints[j].group = n;
    }
  }

  const AssemblyDesign& design_;
  PlacedDesign out_;
};

}  // namespace

PlacedDesign place(const AssemblyDesign& design) { return Placing(design).run(); }

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
