#pragma once

#include <vector>

#include "softpoint/elastic/assembly_design.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// A segment in the rest pose: x = rotation X + origin.
struct PlacedSegment {
  int part = 0, index = 0;  // of the design
  const SegmentModel* model = nullptr;
  Mat3 rotation = Mat3::Identity();
  Vec3 origin = Vec3::Zero();
  std::vector<int> joint;  // of each interface; -1 for a patch that nothing joins
};

// A joining surface: the points of one interface, shared with that of another segment where two meet.
struct PlacedJoint {
  std::vector<Vec3> rest;                      // m, of its points; the first lies on the bone
  std::vector<std::array<int, 2>> interfaces;  // {segment, interface}, one or two
  std::vector<std::vector<int>> order;         // for each of them, joint point of each interface vertex
  int group = 0;
};

// A design laid out at rest: segments of all parts one after another, joints, and which joints hang together.
struct PlacedDesign {
  std::vector<PlacedSegment> segments;
  std::vector<PlacedJoint> joints;
  std::vector<std::vector<int>> part_joints;  // of each part from root to tip, segments + 1
  std::vector<int> first_segment;             // of each part
  int groups = 0;
};

// Throws Error where joining surfaces do not meet one to one. Patches without a join stay free skin of
// their segment's joint points.
PlacedDesign place(const AssemblyDesign& design);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
