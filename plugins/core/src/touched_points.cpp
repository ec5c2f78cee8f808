#include "touched_points.h"

#include <Eigen/Core>

namespace softpoint::inline SOFTPOINT_ABI {

Mat3 TouchedPoints::compliance(int i, int j) const {
  const Eigen::Index n = static_cast<Eigen::Index>(3 * points.size());
  return Eigen::Map<const Eigen::MatrixXd>(blocks.data(), n, n).block<3, 3>(3 * i, 3 * j);
}

void TouchedPoints::find_parts() {
  const auto count = static_cast<int>(points.size());
  part.assign(points.size(), -1);
  for (auto& of_part : runs) of_part.clear();
  int parts = 0;
  for (int j = 0; j < count; ++j) {
    if (part[static_cast<std::size_t>(j)] >= 0) continue;
    if (runs.size() == static_cast<std::size_t>(parts)) runs.emplace_back();
    auto& of_part = runs[static_cast<std::size_t>(parts)];
    for (int i = 0; i < count; ++i) {
      if (i != j && compliance(i, j).isZero(0)) continue;
      if (part[static_cast<std::size_t>(i)] >= 0) {  // no parts after all
        part.assign(points.size(), 0);
        runs.front().assign(1, {0, count});
        return;
      }
      part[static_cast<std::size_t>(i)] = parts;
      if (of_part.empty() || of_part.back()[1] != i) of_part.push_back({i, i});
      of_part.back()[1] = i + 1;
    }
    ++parts;
  }
}

void TouchedPoints::spread(int index, const Vec3& impulse, double dt) {
  const Eigen::Index n = static_cast<Eigen::Index>(3 * points.size());
  const Eigen::Map<const Eigen::MatrixXd> matrix(blocks.data(), n, n);
  const Vec3 step = dt * impulse;
  for (const auto& [first, end] : runs[static_cast<std::size_t>(part[static_cast<std::size_t>(index)])]) {
    const Eigen::Index top = 3 * first, rows = 3 * (end - first);
    Eigen::Map<Eigen::VectorXd> all(displacement[static_cast<std::size_t>(first)].data(), rows);
    const auto column = [&](Eigen::Index k) { return matrix.col(3 * index + k).segment(top, rows); };
    all = all + column(0) * step.x() + column(1) * step.y() + column(2) * step.z();
  }
  impulses[static_cast<std::size_t>(index)] += impulse;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
