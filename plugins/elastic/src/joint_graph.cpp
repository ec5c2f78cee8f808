#include "joint_graph.h"

#include <set>

#include "part_group.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

JointGraph::JointGraph(const PartGroup& group, bool bones) : couplings(group.joints().size()) {
  const std::size_t count = group.joints().size();
  for (const PartGroup::Segment& segment : group.segments()) {
    segment_joints.emplace_back();
    const SegmentModel& model = *group.models()[static_cast<std::size_t>(segment.model)]->model;
    std::size_t first = 0;
    for (const auto& interface : model.interfaces) {
      segment_joints.back().push_back(static_cast<int>(group.joint_at(segment.at[first])));
      first += interface.size();
    }
  }
  std::vector<std::set<int>> neighbours(count);
  for (const auto& joints : segment_joints) {
    for (const int a : joints) {
      for (const int b : joints) {
        if (a != b) neighbours[static_cast<std::size_t>(a)].insert(b);
      }
    }
  }
  for (const PartGroup::Bone& bone : group.bones()) {
    for (std::size_t i = 2; bones && bone.settings.angle_stiffness > 0.0 && i < bone.at.size(); ++i) {
      const std::size_t a = group.joint_at(bone.at[i]), b = group.joint_at(bone.at[i - 2]);
      if (a == b) continue;
      neighbours[a].insert(static_cast<int>(b));
      neighbours[b].insert(static_cast<int>(a));
    }
  }
  std::vector<char> done(count, 0);
  for (std::size_t step = 0; step < count; ++step) {
    std::size_t next = count;
    for (std::size_t i = 0; i < count; ++i) {
      if (done[i] == 0 && (next == count || neighbours[i].size() < neighbours[next].size())) next = i;
    }
    done[next] = 1;
    order.push_back(static_cast<int>(next));
    for (const int a : neighbours[next]) {
      couplings[next].push_back({a, links++});
      auto& of_a = neighbours[static_cast<std::size_t>(a)];
      of_a.erase(static_cast<int>(next));
      for (const int b : neighbours[next]) {
        if (a != b) of_a.insert(b);
      }
    }
  }
}

int JointGraph::link_of(int first, int later) const {
  for (const auto& [joint, link] : couplings[static_cast<std::size_t>(first)]) {
    if (joint == later) return link;
  }
  return -1;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
