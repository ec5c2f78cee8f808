#include "inverse_kinematics.h"

#include "rotation_fit.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
int reach(std::span<Vec3> joints, const Vec3& target, int sweeps, double tolerance) {
  const std::size_t tip = joints.size() - 1;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    if ((joints[tip] - target).norm() <= tolerance) return sweep;
    for (std::size_t i = tip; i-- > 0;) {
      const Vec3 now = joints[tip] - joints[i], wanted = target - joints[i];
      const Mat3 turn = turn_between(now, wanted);
      for (std::size_t k = i + 1; k <= tip; ++k) {
        joints[k] = joints[i] + turn * (joints[k] - joints[i]);
      }
    }
  }
  return sweeps;
}

int place_bone(std::span<Vec3> joints, const Vec3& root, const Vec3& target, int sweeps, double tolerance) {
  const Vec3 shift = root - joints.front();
  for (Vec3& joint : joints) joint += shift;
  joints.front() = root;
  const int done = reach(joints, target, sweeps, tolerance);
  joints.back() = target;
  return done;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
