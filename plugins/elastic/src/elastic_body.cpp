// Dynamics in the turning frame; doc/elastic_dynamics.md derives the numbered stages.
#include "softpoint/elastic/elastic_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <cmath>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

std::vector<Vec3> placed(const ElasticModel& model, const Vec3& origin, const Mat3& rotation) {
  check_finite("ElasticBody: origin", origin);
  check_range(
      "ElasticBody: rotation, distance from a rotation matrix",
      (rotation.transpose() * rotation - Mat3::Identity()).norm() + std::abs(rotation.determinant() - 1.0),
      0.0, 1e-6);
  std::vector<Vec3> positions;
  positions.reserve(model.mesh.vertices.size());
  for (const Vec3& v : model.mesh.vertices) {
    positions.push_back(rotation * v + origin);
  }
  return positions;
}

// Rotation nearest to `a` (polar decomposition), proper also where `a` mirrors.
Mat3 nearest_rotation(const Mat3& a) {
  const Eigen::JacobiSVD<Mat3> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double mirror = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * Vec3(1, 1, mirror).asDiagonal() * svd.matrixV().transpose();
}

// Best fitting frame of positions about their centre of mass: polar(sum m (x - c) X^T).
Mat3 fit_frame(const ElasticModel& model, const std::vector<Vec3>& positions, const Vec3& center) {
  Mat3 moment = Mat3::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    moment += model.masses[v] * (positions[v] - center) * model.rest[v].transpose();
  }
  return nearest_rotation(moment);
}

Vec3 center_of(const ElasticModel& model, const std::vector<Vec3>& positions, double mass) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t v = 0; v < positions.size(); ++v) {
    sum += model.masses[v] * positions[v];
  }
  return sum / mass;
}

Mat3 cross_matrix(const Vec3& a) {
  Mat3 m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

}  // namespace

ElasticBody::ElasticBody(std::shared_ptr<const ElasticModel> model, const Vec3& origin, const Mat3& rotation)
    : Deformable(placed(*model, origin, rotation), model->mesh.triangles, model->masses),
      model_(std::move(model)) {
  frame_ = rotation;
  arms_.resize(positions_.size());
  internal_.resize(positions_.size());
  scratch_in_.resize(3 * positions_.size());
  scratch_out_.resize(3 * positions_.size());
}

void ElasticBody::set_velocity(const Vec3& linear, const Vec3& angular) {
  check_finite("set_velocity: linear", linear);
  check_finite("set_velocity: angular", angular);
  const Vec3 center = center_of_mass();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] = linear + angular.cross(positions_[v] - center);
  }
}

Mat3 ElasticBody::frame() const { return fit_frame(*model_, positions_, center_of_mass()); }

void ElasticBody::displacements(std::vector<double>& out) const {
  const Vec3 center = center_of_mass();
  const Mat3 r = fit_frame(*model_, positions_, center);
  out.resize(3 * positions_.size());
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    Eigen::Map<Vec3>(&out[3 * v]) = r.transpose() * (positions_[v] - center) - model_->rest[v];
  }
}

double ElasticBody::elastic_energy() const {
  std::vector<double> d;
  displacements(d);
  const Eigen::Index n = model_->dofs();
  const Eigen::Map<const Eigen::VectorXd> u(d.data(), n);
  const Eigen::Map<const Eigen::MatrixXd> s(model_->stiffness->unit_stiffness.data(), n, n);
  return 0.5 * model_->material.young * u.dot(s * u);
}

const double* ElasticBody::response() const {
  return own_response_.empty() ? model_->response.data() : own_response_.data();
}

void ElasticBody::choose_response(double dt) {
  dt_ = dt;
  const auto fits = [&](double step) { return std::abs(dt - step) <= 1e-6 * step; };  // btScalar may be float
  if (own_response_.empty() ? fits(model_->time_step) : fits(own_step_)) {
    return;
  }
  if (fits(model_->time_step)) {
    own_response_.clear();
    return;
  }
  compute_response(*model_, dt, own_response_);
  own_step_ = dt;
  ++refactorizations_;
}

// Arms and inertia at the start of the step, about which internal forces must have no net load.
void ElasticBody::measure_start() {
  const Vec3 center = center_of(*model_, positions_, total_mass());
  Mat3 inertia = Mat3::Zero();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    arms_[v] = positions_[v] - center;
    inertia += masses_[v] * (arms_[v].squaredNorm() * Mat3::Identity() - arms_[v] * arms_[v].transpose());
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
  inertia_inverse_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

// Stage 5: end_positions_ += dt (M^-1 impulses), less what of them is a net force or torque.
void ElasticBody::add_free_of_net_load(const std::vector<Vec3>& impulses) {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t v = 0; v < impulses.size(); ++v) {
    force += impulses[v];
    torque += arms_[v].cross(impulses[v]);
  }
  const Vec3 linear = force / total_mass(), angular = inertia_inverse_ * torque;
  for (std::size_t v = 0; v < impulses.size(); ++v) {
    end_positions_[v] += dt_ * (impulses[v] / masses_[v] - linear - angular.cross(arms_[v]));
  }
}

void ElasticBody::predict(double dt) {
  choose_response(dt);
  measure_start();
  // Stage 1: x^ = x + h v.
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_positions_[v] = positions_[v] + dt * velocities_[v];
  }
  // Stage 2: R = polar(sum m (x^ - c) X^T).
  const Vec3 center = center_of(*model_, end_positions_, total_mass());
  frame_ = fit_frame(*model_, end_positions_, center);
  // Stages 3 and 4: d = R^T (x^ - c) - X, delta = -(M + h^2 S)^-1 h^2 S d = (M + h^2 S)^-1 M d - d.
  const Eigen::Index n = model_->dofs();
  Eigen::Map<Eigen::VectorXd> in(scratch_in_.data(), n), out(scratch_out_.data(), n);
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 d = frame_.transpose() * (end_positions_[v] - center) - model_->rest[v];
    internal_[v] = -masses_[v] * d;
    in.segment<3>(static_cast<Eigen::Index>(3 * v)) = masses_[v] * d;
  }
  out.noalias() = Eigen::Map<const Eigen::MatrixXd>(response(), n, n) * in;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    internal_[v] += masses_[v] * out.segment<3>(static_cast<Eigen::Index>(3 * v));
    internal_[v] = frame_ * internal_[v] / dt;
  }
  add_free_of_net_load(internal_);
}

void ElasticBody::compliance(std::span<const int> touched, double* blocks) {
  const Eigen::Index n = model_->dofs();
  const auto count = static_cast<Eigen::Index>(touched.size());
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  Eigen::Map<Eigen::MatrixXd> result(blocks, 3 * count, 3 * count);
  const Mat3& r = frame_;
  for (Eigen::Index j = 0; j < count; ++j) {
    const Eigen::Index column = 3 * touched[static_cast<std::size_t>(j)];
    // Net torque of the internal impulses that answer a unit impulse on point j, about the start.
    Mat3 torque = -cross_matrix(arms_[static_cast<std::size_t>(column / 3)]) * r;
    for (std::size_t v = 0; v < positions_.size(); ++v) {
      torque +=
          cross_matrix(masses_[v] * arms_[v]) * (r * b.block<3, 3>(static_cast<Eigen::Index>(3 * v), column));
    }
    const Mat3 turn = inertia_inverse_ * torque * r.transpose();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index row = 3 * touched[static_cast<std::size_t>(i)];
      result.block<3, 3>(3 * i, 3 * j) =
          r * b.block<3, 3>(row, column) * r.transpose() +
          cross_matrix(arms_[static_cast<std::size_t>(row / 3)]) * turn;  // -(turn x arm)
    }
  }
}

void ElasticBody::respond(std::span<const int> touched, std::span<const Vec3> impulses) {
  const Eigen::Index n = model_->dofs();
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  Eigen::Map<Eigen::VectorXd> out(scratch_out_.data(), n);
  out.setZero();
  for (std::size_t j = 0; j < touched.size(); ++j) {
    const Vec3 local = frame_.transpose() * impulses[j];
    out.noalias() += b.middleCols<3>(3 * touched[j]) * local;
  }
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    internal_[v] = frame_ * (masses_[v] * out.segment<3>(static_cast<Eigen::Index>(3 * v)));
  }
  end_positions_ = free_positions_;
  for (std::size_t j = 0; j < touched.size(); ++j) {
    const auto v = static_cast<std::size_t>(touched[j]);
    internal_[v] -= impulses[j];
    end_positions_[v] += dt_ / masses_[v] * impulses[j];
  }
  add_free_of_net_load(internal_);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
