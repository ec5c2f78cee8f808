#pragma once

#include <span>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI {

// A triangle surface that moves and can be pushed: all that one plugin ever learns of another.
// World frame, SI units. Spans stay valid as long as the surface itself; their contents change
// with every step.
class SOFTPOINT_API Surface {
 public:
  virtual ~Surface() = default;

  virtual std::span<const Vec3> points() const = 0;      // m
  virtual std::span<const Vec3> velocities() const = 0;  // m/s, one per point
  virtual std::span<const Triangle> faces() const = 0;   // counter-clockwise seen from outside

  // Push the surface at the barycentric point `weights` (sum 1) of face `face` with `impulse` (N s).
  // It acts in the next step. Throws Error for a bad face, weights or a non-finite impulse.
  virtual void apply_impulse(int face, const Vec3& weights, const Vec3& impulse) = 0;
};

// Position (m) and velocity (m/s) of a barycentric point of a surface.
SOFTPOINT_API Vec3 point_at(const Surface& surface, int face, const Vec3& weights);
SOFTPOINT_API Vec3 velocity_at(const Surface& surface, int face, const Vec3& weights);

}  // namespace softpoint::inline SOFTPOINT_ABI
