// The stages of an elastic body's free motion; doc/elastic_dynamics.md derives them.
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "elastic_frame.h"
#include "instruction_set.h"
#include "rotation_fit.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

Vec3 center_of(const ElasticModel& model, const std::vector<Vec3>& positions, double mass) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    sum += model.masses[v] * positions[v];
  }
  return sum / mass;
}

}  // namespace

Mat3 fit_frame(const ElasticModel& model, const std::vector<Vec3>& positions, const Vec3& center) {
  Mat3 moment = Mat3::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    moment += model.masses[v] * (positions[v] - center) * model.rest[v].transpose();
  }
  return nearest_rotation(moment);
}

// Pseudo-inverse of the inertia about the centre of mass of points at `arms` (m) from it.
Mat3 ElasticBody::inverse_inertia(const std::vector<Vec3>& arms) const {
  Mat3 inertia = Mat3::Zero();
  for (std::size_t v = 0; v < arms.size(); ++v) {
    inertia += masses_[v] * (arms[v].squaredNorm() * Mat3::Identity() - arms[v] * arms[v].transpose());
  }
  // A body pulled into a line has no inertia about it: leave that axis out.
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia);
  const Vec3 values = eigen.eigenvalues();
  Vec3 inverse = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    if (values[i] > 1e-12 * values[2]) {
      inverse[i] = 1.0 / values[i];
    }
  }
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

// Stage 1: motion as seen from the centre of mass, v = v_c + omega x r + w with w free of spin.
void ElasticBody::split_motion() {
  start_center_ = center_of(*model_, positions_, total_mass());
  center_velocity_ = momentum() / total_mass();
  spin_.setZero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    arms_[v] = positions_[v] - start_center_;
    spin_ += masses_[v] * arms_[v].cross(velocities_[v] - center_velocity_);
  }
  inverse_inertia_ = inverse_inertia(arms_);
  const Vec3 omega = inverse_inertia_ * spin_;
  double internal = 0.0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    shape_velocity_[v] = velocities_[v] - center_velocity_ - omega.cross(arms_[v]);
    internal += 0.5 * masses_[v] * shape_velocity_[v].squaredNorm();
  }
  energy_at_start_ = 0.5 * spin_.dot(omega) + internal + strain_energy_;
  start_frame_ = frame_;
  start_strain_energy_ = strain_energy_;
  start_strain_ = strain_;
  start_force_ = force_;
}

// A turn after which a body with this inverse inertia and spin (constant in the world) has the rotational
// energy `wanted`, found from `turn` by Newton steps: a small turn e changes 1/2 L . I^-1 L by e . (omega x
// L). `turn` is left alone so near to a principal axis that no small turn helps.
void ElasticBody::correct_turn(Mat3& turn, const Mat3& inverse, double wanted) const {
  for (int i = 0; i < 4; ++i) {
    const Vec3 omega = turn * (inverse * (turn.transpose() * spin_));
    const double excess = 0.5 * spin_.dot(omega) - wanted;
    const Vec3 gradient = omega.cross(spin_);
    const double angle = excess / gradient.norm();
    if (std::abs(excess) <= 1e-15 * wanted || !(std::abs(angle) < dt_ * omega.norm())) {
      return;
    }
    turn = turn_by(-angle * gradient.normalized()) * turn;
  }
}

// Stage 2: turn as a free rigid body does (midpoint rule, spin constant in the world, energy kept), and let
// the shape move on in the turning frame: r^ = Q [r + h w + h^2 a], a = -omega x (omega x r) - 2 omega x w -
// omega' x r, where the Euler term is what leaves a without torque: Q has all of the turn.
void ElasticBody::predict_positions() {
  const Vec3 omega = inverse_inertia_ * spin_;
  const Mat3 half = turn_by(0.5 * dt_ * omega);
  turn_ = turn_by(dt_ * (half * inverse_inertia_ * half.transpose() * spin_));
  correct_turn(turn_, inverse_inertia_, 0.5 * spin_.dot(omega));
  Vec3 torque = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    inertial_[v] = -omega.cross(omega.cross(arms_[v]) + 2.0 * shape_velocity_[v]);
    torque += masses_[v] * arms_[v].cross(inertial_[v]);
  }
  const Vec3 euler = inverse_inertia_ * torque;
  const Vec3 center = start_center_ + dt_ * center_velocity_;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 a = inertial_[v] - euler.cross(arms_[v]);
    end_positions_[v] = center + turn_ * (arms_[v] + dt_ * (shape_velocity_[v] + dt_ * a));
  }
}

// scratch_out_ = (M + h^2 S)^-1 scratch_in_.
void ElasticBody::multiply_response() {
  const Kernels& kernels = kernels_for(model_->stiffness->instruction_set);
  const std::ptrdiff_t n = model_->dofs();
  if (single_in_.empty() || !own_response_.empty()) {
    kernels.symmetric_double(response(), n, n, scratch_in_.data(), scratch_out_.data());
    return;
  }
  std::transform(scratch_in_.begin(), scratch_in_.end(), single_in_.begin(),
                 [](double v) { return static_cast<float>(v); });
  kernels.packed_symmetric_single(model_->single_response.data(), n, single_in_.data(), single_out_.data());
  std::copy_n(single_out_.begin(), n, scratch_out_.begin());
}

// Stages 3 and 4: R = polar(sum m (x^ - c) X^T), d = R^T (x^ - c) - X,
// delta = -(M + h^2 S)^-1 h^2 S d = (M + h^2 S)^-1 M d - d, x = x^ + R delta.
void ElasticBody::relax_shape() {
  const Vec3 center = center_of(*model_, end_positions_, total_mass());
  frame_ = fit_frame(*model_, end_positions_, center);
  const Eigen::Index n = model_->dofs();
  Eigen::Map<Eigen::VectorXd> in(scratch_in_.data(), n), out(scratch_out_.data(), n);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 d = frame_.transpose() * (end_positions_[v] - center) - model_->rest[v];
    in.segment<3>(static_cast<Eigen::Index>(3 * v)) = masses_[v] * d;
  }
  multiply_response();
  Vec3 drift = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const auto i = static_cast<Eigen::Index>(3 * v);
    strain_[v] = out.segment<3>(i);  // d + delta
    // h^2 S (d + delta) = -M delta: the elastic force comes for free.
    force_[v] = (in.segment<3>(i) - masses_[v] * strain_[v]) / (dt_ * dt_);
    drift += masses_[v] * strain_[v];
  }
  drift /= total_mass();
  strain_energy_ = 0.0;
  const Vec3 end_center = start_center_ + dt_ * center_velocity_;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    strain_[v] -= drift;  // rounding only: internal forces have no net force
    strain_energy_ += 0.5 * strain_[v].dot(force_[v]);
    end_positions_[v] = end_center + frame_ * (model_->rest[v] + strain_[v]);
  }
}

// Stage 5: velocities with the spin of the start to rounding, and no more energy than at the start.
void ElasticBody::settle_free_motion() {
  const Vec3 center = start_center_ + dt_ * center_velocity_;
  // w = (r' - Q r) / h without its spin.
  Vec3 false_spin = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_arms_[v] = end_positions_[v] - center;
    shape_velocity_[v] = (end_arms_[v] - turn_ * arms_[v]) / dt_;
    false_spin += masses_[v] * end_arms_[v].cross(shape_velocity_[v]);
  }
  const Mat3 inverse = inverse_inertia(end_arms_);
  const Vec3 false_turn = inverse * false_spin;
  Vec3 drift = Vec3::Zero();
  double internal = 0.0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    shape_velocity_[v] -= false_turn.cross(end_arms_[v]);
    drift += masses_[v] * shape_velocity_[v];
  }
  drift /= total_mass();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    shape_velocity_[v] -= drift;
    internal += 0.5 * masses_[v] * shape_velocity_[v].squaredNorm();
  }
  if (loaded()) {
    energy_at_start_ = std::max(energy_at_start_ + work_of_loads(), 0.0);
  }
  Vec3 omega = inverse * spin_;
  const double rigid = 0.5 * spin_.dot(omega);
  if (rigid + internal + strain_energy_ > energy_at_start_) {
    omega = give_up_energy(center, inverse, rigid, internal);
  }
  // Rounding in the terms would drift over many small steps: compare the sum with the spin of the start.
  Vec3 spin = Vec3::Zero(), momentum = Vec3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    free_velocities_[v] = omega.cross(end_arms_[v]) + shape_velocity_[v];
    spin += masses_[v] * end_arms_[v].cross(free_velocities_[v]);
    momentum += masses_[v] * free_velocities_[v];
  }
  const Vec3 rounding = inverse * (spin_ - spin), velocity = center_velocity_ - momentum / total_mass();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    free_velocities_[v] += velocity + rounding.cross(end_arms_[v]);
  }
}

// The vibration gives up what is too much; then a tumbling body is turned a little towards the attitude that
// has the right energy; last, the shape of the start is kept for this step, which has no more energy by
// construction. Returns the angular velocity.
Vec3 ElasticBody::give_up_energy(const Vec3& center, const Mat3& inverse, double rigid, double internal) {
  const double left = std::max(energy_at_start_ - rigid - strain_energy_, 0.0);
  const double keep = internal > 0.0 ? std::sqrt(left / internal) : 0.0;
  for (Vec3& w : shape_velocity_) {
    w *= keep;
  }
  if (rigid + strain_energy_ <= energy_at_start_) {
    return inverse * spin_;
  }
  Mat3 q = Mat3::Identity();
  correct_turn(q, inverse, (1.0 - 1e-15) * energy_at_start_ - strain_energy_);
  Vec3 omega = q * (inverse * (q.transpose() * spin_));
  constexpr double kRounding = 1e-13;
  if (0.5 * spin_.dot(omega) + strain_energy_ <= (1.0 + kRounding) * energy_at_start_) {
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      end_arms_[v] = q * end_arms_[v];
      shape_velocity_[v] = q * shape_velocity_[v];
      end_positions_[v] = center + end_arms_[v];
    }
    frame_ = q * frame_;
    return omega;
  }
  // The books may be too low: frames differ between the steps of a body that is crushed flat. Count anew.
  const double counted = strain_energy_of(arms_) - start_strain_energy_;
  if (counted > 0.0 && 0.5 * spin_.dot(inverse * spin_) + strain_energy_ <= energy_at_start_ + counted) {
    return inverse * spin_;
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_arms_[v] = turn_ * arms_[v];
    shape_velocity_[v].setZero();
    end_positions_[v] = center + end_arms_[v];
  }
  strain_ = start_strain_;
  force_ = start_force_;
  frame_ = turn_ * start_frame_;
  strain_energy_ = start_strain_energy_;
  return turn_ * (inverse_inertia_ * (turn_.transpose() * spin_));
}

void ElasticBody::predict(double dt) {
  choose_response(dt);
  split_motion();
  predict_positions();
  relax_shape();
  if (loaded()) {
    carry_loads();
  }
  settle_free_motion();
  pushed_ = false;
  // The matrix B answers impulses on the turned and relaxed shape, so that is where their torque is counted:
  // on the strained shape of the start, elastic forces that balance them would turn the body on.
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    impulse_points_[v] = end_positions_[v] - dt * center_velocity_;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
