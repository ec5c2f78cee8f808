#pragma once

#include <array>
#include <optional>
#include <vector>

#include "softpoint/core/config.h"
#include "softpoint/core/vec.h"

// Curves through values at given times whose accelerations are continuous: what a prescribed joint follows.
namespace softpoint::inline SOFTPOINT_ABI::figure {

struct SplinePoint {
  double value = 0, rate = 0, acceleration = 0;
};

// What a spline does at its first or last time: the rate it is given there; else no acceleration (natural);
// else, the default, its first (last) two pieces are one cubic ("not a knot"), which keeps the order of the
// interior.
struct SplineEnd {
  std::optional<double> rate;
  bool natural = false;
};

// Cubic spline, C2. Two points make a line, three without a rate a parabola.
class SOFTPOINT_API CubicSpline {
 public:
  // Throws Error unless there are at least two times, they increase, there is a value each and all is finite.
  CubicSpline(std::vector<double> times, std::vector<double> values, const SplineEnd& first = {},
              const SplineEnd& last = {});
  // Beyond the ends the first and the last piece go on. Allocates nothing.
  SplinePoint at(double time) const;
  double first_time() const { return times_.front(); }
  double last_time() const { return times_.back(); }

 private:
  std::vector<double> times_, values_, rates_;
};

// Orientation (w, x, y, z; a unit quaternion), angular velocity and acceleration in the axes of what turns:
// the numbers of a ball joint.
struct TurnSplinePoint {
  std::array<double, 4> turn = {1, 0, 0, 0};
  Vec3 spin = Vec3::Zero();         // rad/s
  Vec3 spin_change = Vec3::Zero();  // rad/s2
};

// Angular velocity at an end, in the axes of what turns; without one that of a cubic through the nearest four
// turns.
struct TurnSplineEnd {
  std::optional<Vec3> spin;
};

// Spline of orientations: from each to the next by the exponential of a cubic, angular velocity and
// acceleration continuous. It goes the short way between neighbours, and so wants them less than half a turn
// apart.
class SOFTPOINT_API TurnSpline {
 public:
  // Throws Error like CubicSpline's, and for quaternions of length 0; makes them unit ones.
  TurnSpline(std::vector<double> times, std::vector<std::array<double, 4>> turns,
             const TurnSplineEnd& first = {}, const TurnSplineEnd& last = {});
  TurnSplinePoint at(double time) const;
  double first_time() const { return times_.front(); }
  double last_time() const { return times_.back(); }

 private:
  std::vector<double> times_;
  std::vector<std::array<double, 4>> turns_;
  // Per piece, turn vectors (rad) in the axes of its beginning: its end, and rates (rad/s) at both ends.
  std::vector<Vec3> rises_, rates0_, rates1_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
