#pragma once

#include "softpoint/core/vec.h"

// Distances of segments in closed form; a capsule's is less its radius.
namespace softpoint::inline SOFTPOINT_ABI::figure {

struct SegmentDistance {
  double distance = 0;          // m; negative: depth of the segment in the box
  double at = 0;                // of the nearest point of the (first) segment, 0 to 1
  Vec3 normal = Vec3::UnitZ();  // unit, from the other to the first
};

// Between two segments a0 a1 and b0 b1.
SegmentDistance segment_to_segment(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);
// From a segment, in the box's frame, to the box |x_i| <= half_i. Of a segment inside, the smallest shift out
// of it: over the normals of the box's faces and the directions across the segment and an edge.
SegmentDistance segment_to_box(const Vec3& a0, const Vec3& a1, const Vec3& half);
// From a segment to a triangle. Of one that goes through it, minus the length by which the shorter end does.
SegmentDistance segment_to_triangle(const Vec3& a0, const Vec3& a1, const Vec3& u, const Vec3& v,
                                    const Vec3& w);

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
