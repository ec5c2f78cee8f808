#include "foot_solver.h"

#include <Eigen/LU>
#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::figure {

FootSolver::FootSolver(const FigureModel& model, int link, const Vec3& point)
    : model_(&model), chain_(model, link), point_(point) {
  for (const int i : chain_.links()) {
    const JointKind kind = model.links()[static_cast<std::size_t>(i)].joint;
    if (kind == JointKind::kHinge || kind == JointKind::kPrismatic) joints_.push_back(i);
  }
  columns_.resize(joints_.size());
  change_.resize(joints_.size());
  unit_.resize(static_cast<std::size_t>(model.velocity_count()));
}

Vec3 FootSolver::where(const FigureState& state) const {
  return chain_.evaluate(point_, state.q.data(), nullptr, nullptr).position;
}

void FootSolver::jacobian(const FigureState& state) {
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    double& one = unit_[static_cast<std::size_t>(model_->velocity_offset(joints_[k]))];
    one = 1;
    columns_[k] = chain_.evaluate(point_, state.q.data(), unit_.data(), nullptr).velocity;
    one = 0;
  }
}

void FootSolver::step(const Vec3& by, double damping) {
  Mat3 square = damping * Mat3::Identity();
  for (const Vec3& column : columns_) square += column * column.transpose();
  const Vec3 push = square.inverse() * by;
  for (std::size_t k = 0; k < joints_.size(); ++k) change_[k] = columns_[k].dot(push);
}

double FootSolver::solve(const Vec3& place, FigureState& state) {
  double missing = (place - where(state)).norm();
  for (int round = 0; round < 30 && missing > 1e-12; ++round) {
    jacobian(state);
    step(place - where(state), 1e-4 * std::min(1.0, missing * missing) + 1e-14);
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      const Link& link = model_->links()[static_cast<std::size_t>(joints_[k])];
      double& q = state.q[static_cast<std::size_t>(model_->position_offset(joints_[k]))];
      q = std::clamp(q + std::clamp(change_[k], -0.3, 0.3), link.lower, link.upper);
    }
    missing = (place - where(state)).norm();
  }
  jacobian(state);
  step(-chain_.evaluate(point_, state.q.data(), state.qd.data(), nullptr).velocity, 1e-10);
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    state.qd[static_cast<std::size_t>(model_->velocity_offset(joints_[k]))] += change_[k];
  }
  return missing;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
