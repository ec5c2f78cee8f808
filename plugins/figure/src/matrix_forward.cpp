#include "matrix_forward.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

// Inverse dynamics of accelerations or loads alone: nothing accelerates the world meanwhile.
class NoGravity {
 public:
  explicit NoGravity(FigureDynamics& dynamics)
      : dynamics_(dynamics), gravity_(dynamics.gravity()), base_(dynamics.base_acceleration()) {
    dynamics.set_gravity(Vec3::Zero());
    dynamics.set_base_acceleration(Vec3::Zero());
  }
  ~NoGravity() {
    dynamics_.set_gravity(gravity_);
    dynamics_.set_base_acceleration(base_);
  }
  NoGravity(const NoGravity&) = delete;
  NoGravity& operator=(const NoGravity&) = delete;

 private:
  FigureDynamics& dynamics_;
  Vec3 gravity_, base_;
};

}  // namespace

MatrixForward::MatrixForward(const FigureModel& model) {
  const auto n = static_cast<std::size_t>(model.velocity_count());
  for (std::vector<double>* v : {&given_, &zero_, &unit_, &column_, &x_}) v->assign(n, 0.0);
  at_.resize(static_cast<std::size_t>(model.position_count()));
  factors_.resize(n * n);
  free_.reserve(n);
  for (const Link& link : model.links()) {
    const double damping = link.joint == JointKind::kFree ? 0 : link.damping;  // nothing rubs there
    damping_.insert(damping_.end(), static_cast<std::size_t>(velocity_count(link.joint)), damping);
  }
}

void MatrixForward::forward(FigureDynamics& dynamics, const double* q, const double* qd, const double* tau,
                            double* qdd, std::span<const Wrench> loads, double implicit_time) {
  const FigureModel& model = dynamics.model();
  std::copy_n(q, at_.size(), at_.begin());
  std::copy_n(qdd, given_.size(), given_.begin());
  free_.clear();
  for (int i = 0; i < model.link_count(); ++i) {
    if (!dynamics.dynamic(i)) continue;
    const int v = model.velocity_offset(i);
    for (int k = 0; k < velocity_count(model.links()[static_cast<std::size_t>(i)].joint); ++k) {
      free_.push_back(v + k);
      given_[static_cast<std::size_t>(v + k)] = 0;
    }
  }
  dynamics.inverse(q, qd, given_.data(), column_.data(), loads);
  const std::size_t n = free_.size();
  for (std::size_t k = 0; k < n; ++k) {
    const int v = free_[k];
    x_[k] = (tau != nullptr ? tau[v] : 0) - column_[static_cast<std::size_t>(v)];
  }
  {
    const NoGravity alone(dynamics);
    for (std::size_t j = 0; j < n; ++j) {
      const auto v = static_cast<std::size_t>(free_[j]);
      unit_[v] = 1;
      dynamics.inverse(q, zero_.data(), unit_.data(), column_.data());
      unit_[v] = 0;
      for (std::size_t i = 0; i < n; ++i) factors_[i * n + j] = column_[static_cast<std::size_t>(free_[i])];
      factors_[j * n + j] += implicit_time * damping_[v];
    }
  }
  factor();
  solve(x_.data());
  for (std::size_t k = 0; k < n; ++k) qdd[free_[k]] = x_[k];
}

void MatrixForward::respond(FigureDynamics& dynamics, std::span<const Wrench> loads, double* change) {
  {
    const NoGravity alone(dynamics);
    dynamics.inverse(at_.data(), zero_.data(), zero_.data(), column_.data(), loads);
  }
  for (double& torque : column_) torque = -torque;  // what would hold the loads
  respond_to_torques(column_.data(), change);
}

void MatrixForward::respond_to_torques(const double* tau, double* change) {
  for (std::size_t k = 0; k < free_.size(); ++k) x_[k] = tau[free_[k]];
  solve(x_.data());
  for (std::size_t k = 0; k < free_.size(); ++k) change[free_[k]] = x_[k];
}

void MatrixForward::factor() {
  const std::size_t n = free_.size();
  double* a = factors_.data();
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k) a[j * n + j] -= a[j * n + k] * a[j * n + k] * a[k * n + k];
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) a[i * n + j] -= a[i * n + k] * a[j * n + k] * a[k * n + k];
      a[i * n + j] /= a[j * n + j];
    }
  }
}

void MatrixForward::solve(double* x) const {
  const std::size_t n = free_.size();
  const double* a = factors_.data();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= a[i * n + k] * x[k];
  }
  for (std::size_t i = 0; i < n; ++i) x[i] /= a[i * n + i];
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= a[k * n + i] * x[k];
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
