#include "touched_points.h"

#include <Eigen/Core>

namespace softpoint::inline SOFTPOINT_ABI {

Mat3 TouchedPoints::compliance(int i, int j) const {
  const Eigen::Index n = static_cast<Eigen::Index>(3 * points.size());
  return Eigen::Map<const Eigen::MatrixXd>(blocks.data(), n, n).block<3, 3>(3 * i, 3 * j);
}

void TouchedPoints::spread(int index, const Vec3& impulse, double dt) {
  const Eigen::Index n = static_cast<Eigen::Index>(3 * points.size());
  Eigen::Map<Eigen::VectorXd> all(displacement.front().data(), n);
  const Eigen::Map<const Eigen::MatrixXd> matrix(blocks.data(), n, n);
  const Vec3 step = dt * impulse;
  all = all + matrix.col(3 * index) * step.x() + matrix.col(3 * index + 1) * step.y() +
        matrix.col(3 * index + 2) * step.z();
  impulses[static_cast<std::size_t>(index)] += impulse;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
