#pragma once

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// The largest and smallest numbers taken from outside: far beyond any use, near enough that products of them
// stay finite in Bullet's single precision.

// Bodies, handles and targets, along an axis from the origin, m.
inline constexpr double kMaxPosition = 1e6;
// Ends of a ray, along an axis from the origin, m.
inline constexpr double kMaxRay = 1e9;
// A mesh's diagonal and generated lengths, m.
inline constexpr double kMinMeshSize = 1e-9;
// A mesh's vertices and generated lengths, m.
inline constexpr double kMaxMeshCoordinate = 1e9;
// Velocities, m/s.
inline constexpr double kMaxSpeed = 1e6;
// Angular velocities, rad/s.
inline constexpr double kMaxSpin = 1e6;
// Accelerations and gravity, m/s2.
inline constexpr double kMaxAcceleration = 1e6;
// Impulses, N s.
inline constexpr double kMaxImpulse = 1e9;
// One point of a deformable, kg.
inline constexpr double kMinPointMass = 1e-20;
// One point of a deformable, kg.
inline constexpr double kMaxPointMass = 1e15;

}  // namespace softpoint::inline SOFTPOINT_ABI
