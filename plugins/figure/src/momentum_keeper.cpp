#include "momentum_keeper.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace softpoint::inline SOFTPOINT_ABI::figure {

MomentumKeeper::MomentumKeeper(const FigureModel& model)
    : placer_(model), unit_(static_cast<std::size_t>(model.velocity_count()), 0.0) {}

void MomentumKeeper::keep(const Vec3& gravity, double dt, const FigureState& from, const FigureState& to,
                          std::vector<double>& rates) {
  placer_.place(from.q.data(), from.qd.data());
  const FigureMechanics before = placer_.mechanics();
  const double mass = placer_.model().total_mass();
  const Vec3 push = mass * dt * gravity;
  const Vec3 arm = before.center_of_mass + 0.5 * dt / mass * before.momentum;
  const Vec3 momentum = before.momentum + push, angular = before.angular_momentum + arm.cross(push);
  placer_.place(to.q.data(), to.qd.data());
  const FigureMechanics now = placer_.mechanics();
  Eigen::Matrix<double, 6, 6> block;
  const auto v = static_cast<std::size_t>(placer_.model().velocity_offset(0));
  for (int k = 0; k < 6; ++k) {
    unit_[v + static_cast<std::size_t>(k)] = 1;
    placer_.place(to.q.data(), unit_.data());
    const FigureMechanics gain = placer_.mechanics();
    block.col(k) << gain.angular_momentum, gain.momentum;
    unit_[v + static_cast<std::size_t>(k)] = 0;
  }
  Eigen::Matrix<double, 6, 1> missing;
  missing << angular - now.angular_momentum, momentum - now.momentum;
  const Eigen::Matrix<double, 6, 1> gain = block.partialPivLu().solve(missing);
  for (int k = 0; k < 6; ++k) rates[v + static_cast<std::size_t>(k)] += gain[k];
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
