#pragma once

#include <span>

#include "softpoint/elastic/assembly_design.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Lengths and angles of a bone at rest.
struct BoneShape {
  std::vector<double> lengths;  // m, l_1 to l_N
  std::vector<double> angles;   // rad, theta_0 of the N - 1 inner joints
};

// As the joints X_0 to X_N lie.
BoneShape bone_shape(std::span<const Vec3> joints);

// Energy (J) of a bone whose joints lie at X_0 to X_N; adds its gradient (N, the opposite of the forces (5)
// and (6)) to `gradient`. Angles lose their hold where a bone is folded to nothing, where they have no sense.
double bone_energy(const BoneSettings& settings, const BoneShape& shape, std::span<const Vec3> joints,
                   std::span<Vec3> gradient);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
