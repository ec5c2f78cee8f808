#pragma once

#include "lane_math.h"
#include "softpoint/core/vec.h"

// Between the lane types of one figure and Eigen's.
namespace softpoint::inline SOFTPOINT_ABI::figure {

inline V3<double> lanes(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 vector(const V3<double>& v) { return {v.x, v.y, v.z}; }
inline M3<double> lanes(const Mat3& m) {
  return {lanes(Vec3(m.col(0))), lanes(Vec3(m.col(1))), lanes(Vec3(m.col(2)))};
}
inline Mat3 matrix(const M3<double>& m) {
  Mat3 result;
  result << vector(m.x), vector(m.y), vector(m.z);
  return result;
}
inline Mat3 matrix(const S3<double>& s) {
  Mat3 result;
  result << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
