// How an elastic body answers impulses from contact and handles (D4 in doc/elastic_dynamics.md).
#include <algorithm>

#include <Eigen/Geometry>

#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// dv_i / dJ_j = R [(M + h^2 S)^-1]_ij R^T.
void ElasticBody::compliance(std::span<const int> touched, double* blocks) {
  const Eigen::Index n = model_->dofs();
  const auto count = static_cast<Eigen::Index>(touched.size());
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  Eigen::Map<Eigen::MatrixXd> result(blocks, 3 * count, 3 * count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < count; ++i) {
      result.block<3, 3>(3 * i, 3 * j) =
          frame_ *
          b.block<3, 3>(3 * touched[static_cast<std::size_t>(i)], 3 * touched[static_cast<std::size_t>(j)]) *
          frame_.transpose();
    }
  }
  if (has_springs()) {
    stiffen(touched, blocks);
  }
}

void ElasticBody::respond(std::span<const int> touched, std::span<const Vec3> impulses) {
  const Eigen::Index n = model_->dofs();
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  Eigen::Map<Eigen::VectorXd> out(scratch_out_.data(), n);
  out.setZero();
  pushed_spin_ = spin_;
  pushed_momentum_ = total_mass() * center_velocity_;
  for (std::size_t j = 0; j < touched.size(); ++j) {
    const Vec3 local = frame_.transpose() * impulses[j];
    out.noalias() += b.middleCols<3>(3 * touched[j]) * local;
    pushed_spin_ +=
        (impulse_points_[static_cast<std::size_t>(touched[j])] - start_center_).cross(impulses[j]);
    pushed_momentum_ += impulses[j];
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    response_velocity_[v] = out.segment<3>(static_cast<Eigen::Index>(3 * v));
  }
  // Strain energy of the pushed shape, again without a product by S: h S B J = (J - M B J) / h.
  strain_energy_pushed_ = 0.0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    pushed_force_[v] = force_[v] - masses_[v] / dt_ * response_velocity_[v];
  }
  for (std::size_t j = 0; j < touched.size(); ++j) {
    pushed_force_[static_cast<std::size_t>(touched[j])] += frame_.transpose() * impulses[j] / dt_;
  }
  if (has_springs()) {
    react(touched, impulses);
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_positions_[v] = free_positions_[v] + dt_ * (frame_ * response_velocity_[v]);
    strain_energy_pushed_ += 0.5 * (strain_[v] + dt_ * response_velocity_[v]).dot(pushed_force_[v]);
  }
  pushed_ = true;
}

void ElasticBody::commit(double dt) {
  if (!pushed_) {
    positions_ = end_positions_;
    velocities_ = free_velocities_;
    return;
  }
  strain_energy_ = std::max(strain_energy_pushed_, 0.0);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    strain_[v] += dt * response_velocity_[v];
    force_[v] = pushed_force_[v];
  }
  // Positions are final. The impulses acted at the start of the step: give the velocities exactly the
  // momentum and spin that follow from them there.
  const Vec3 center_velocity = pushed_momentum_ / total_mass();
  Vec3 momentum = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] = free_velocities_[v] + (end_positions_[v] - free_positions_[v]) / dt;
    momentum += masses_[v] * velocities_[v];
    positions_[v] = end_positions_[v];
  }
  const Vec3 drift = momentum / total_mass() - center_velocity;
  const Vec3 center = center_of_mass();
  Vec3 spin = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    arms_[v] = positions_[v] - center;
    velocities_[v] -= drift;
    spin += masses_[v] * arms_[v].cross(velocities_[v]);
  }
  const Vec3 change = inverse_inertia(arms_) * (pushed_spin_ - spin);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] += change.cross(arms_[v]);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
