#pragma once

#include <span>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Cyclic coordinate descent: turns the bones of a chain whose joints lie at X_0 to X_N, joint by joint from
// the tip to the root, until X_N is within `tolerance` (m) of `target` or `sweeps` are done; lengths stay,
// and so does X_0. Returns the sweeps done.
int reach(std::span<Vec3> joints, const Vec3& target, int sweeps, double tolerance);

// The same with the root set down at `root` first, and the last bone lengthened to the target in the end
// where it is out of reach.
int place_bone(std::span<Vec3> joints, const Vec3& root, const Vec3& target, int sweeps, double tolerance);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
