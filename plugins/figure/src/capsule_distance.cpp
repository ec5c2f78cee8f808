#include "capsule_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// Any unit vector across another.
Vec3 across(const Vec3& direction) {
  int smallest = 0;
  direction.cwiseAbs().minCoeff(&smallest);
  const Vec3 n = direction.cross(Vec3(Vec3::Unit(smallest)));
  return n.norm() > 0 ? Vec3(n.normalized()) : Vec3(Vec3::UnitZ());
}

// Half the derivative by t of the squared distance of a0 + t d from the box: it never falls.
double slope_at(const Vec3& a0, const Vec3& d, const Vec3& half, double t) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double x = a0[k] + t * d[k];
    if (x > half[k]) sum += (x - half[k]) * d[k];
    if (x < -half[k]) sum += (x + half[k]) * d[k];
  }
  return sum;
}

// Where that is zero: on it is linear between the times at which the line passes a face.
double nearest_to_box(const Vec3& a0, const Vec3& d, const Vec3& half) {
  double times[8] = {0, 1};
  int count = 2;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {-1.0, 1.0}) {
      const double t = d[k] == 0 ? -1 : (side * half[k] - a0[k]) / d[k];
      if (t > 0 && t < 1) times[count++] = t;
    }
  }
  for (int i = 1; i < count; ++i) {
    for (int k = i; k > 0 && times[k] < times[k - 1]; --k) std::swap(times[k], times[k - 1]);
  }
  double before = slope_at(a0, d, half, 0);
  if (before >= 0) return 0;
  for (int i = 1; i < count; ++i) {
    const double after = slope_at(a0, d, half, times[i]);
    if (after >= 0) {
      return times[i - 1] + (times[i] - times[i - 1]) * (after > before ? -before / (after - before) : 0);
    }
    before = after;
  }
  return 1;
}

}  // namespace

SegmentDistance segment_to_segment(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 d = a1 - a0, e = b1 - b0, r = a0 - b0;
  const double dd = d.dot(d), ee = e.dot(e), de = d.dot(e), dr = d.dot(r), er = e.dot(r);
  const auto on = [](double top, double bottom) {
    return bottom > 0 ? std::clamp(top / bottom, 0.0, 1.0) : 0;
  };
  SegmentDistance best;
  best.distance = 1e300;
  const auto look = [&](double s, double t) {
    const Vec3 between = r + s * d - t * e;
    const double length = between.norm();
    if (length >= best.distance) return;
    best = {length, s, length > 1e-12 ? Vec3(between / length) : across(d)};
  };
  const double cross = dd * ee - de * de;
  if (cross > 1e-14 * dd * ee) {
    const double s = std::clamp((de * er - ee * dr) / cross, 0.0, 1.0);
    const double t = on(er + s * de, ee);
    look(on(t * de - dr, dd), t);
  }
  // Ends: all there is for parallel ones, and where the inside's rounding may have been worse.
  for (const double t : {0.0, 1.0}) look(on(t * de - dr, dd), t);
  for (const double s : {0.0, 1.0}) look(s, on(er + s * de, ee));
  return best;
}

SegmentDistance segment_to_box(const Vec3& a0, const Vec3& a1, const Vec3& half) {
  const Vec3 d = a1 - a0;
  SegmentDistance result;
  result.at = nearest_to_box(a0, d, half);
  const Vec3 point = a0 + result.at * d;
  const Vec3 outward = point - point.cwiseMin(half).cwiseMax(-half);
  result.distance = outward.norm();
  if (result.distance > 1e-12) {
    result.normal = outward / result.distance;
    return result;
  }
  double shallow = 1e300;
  const auto look = [&](const Vec3& axis) {  // of unit length
    const double reach = axis.cwiseAbs().dot(half);
    for (const double side : {-1.0, 1.0}) {
      const double low = side * axis.dot(a0), high = side * axis.dot(a1);
      const double depth = reach - std::min(low, high);
      if (depth >= shallow) continue;
      shallow = depth;
      result.normal = side * axis;
      result.at = low < high ? 0 : low > high ? 1 : 0.5;
    }
  };
  for (int k = 0; k < 3; ++k) {
    look(Vec3(Vec3::Unit(k)));
    const Vec3 axis = d.cross(Vec3(Vec3::Unit(k)));
    if (axis.squaredNorm() > 1e-12 * d.squaredNorm()) look(axis.normalized());
  }
  result.distance = -std::max(0.0, shallow);
  return result;
}

SegmentDistance segment_to_triangle(const Vec3& a0, const Vec3& a1, const Vec3& u, const Vec3& v,
                                    const Vec3& w) {
  SegmentDistance best = segment_to_segment(a0, a1, u, v);
  for (const SegmentDistance& d : {segment_to_segment(a0, a1, v, w), segment_to_segment(a0, a1, w, u)}) {
    if (d.distance < best.distance) best = d;
  }
  const Vec3 across_all = (v - u).cross(w - u);
  const double twice_area = across_all.norm();
  if (!(twice_area > 0)) return best;
  const Vec3 n = across_all / twice_area;
  const auto above = [&](const Vec3& x) {  // its foot lies inside
    return (v - u).cross(x - u).dot(n) >= 0 && (w - v).cross(x - v).dot(n) >= 0 &&
           (u - w).cross(x - w).dot(n) >= 0;
  };
  const double h0 = n.dot(a0 - u), h1 = n.dot(a1 - u);
  if (h0 * h1 < 0 && above(a0 + h0 / (h0 - h1) * (a1 - a0))) {
    const bool first_is_short = std::abs(h0) < std::abs(h1);
    const double longer = first_is_short ? h1 : h0;
    return {-std::min(std::abs(h0), std::abs(h1)), first_is_short ? 0.0 : 1.0, longer > 0 ? n : Vec3(-n)};
  }
  if (std::abs(h0) < best.distance && above(a0)) best = {std::abs(h0), 0, h0 > 0 ? n : Vec3(-n)};
  if (std::abs(h1) < best.distance && above(a1)) best = {std::abs(h1), 1, h1 > 0 ? n : Vec3(-n)};
  return best;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
