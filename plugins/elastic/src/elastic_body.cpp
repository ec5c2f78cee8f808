#include "softpoint/elastic/elastic_body.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "elastic_frame.h"
#include "instruction_set.h"
#include "point_loads.h"
#include "rotation_fit.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"
#include "symmetric_layout.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

std::vector<Vec3> placed(const ElasticModel* model, const Vec3& origin, const Mat3& rotation) {
  if (model == nullptr) {
    throw Error("ElasticBody: model is null; permitted is one of make_elastic_model");
  }
  check_range("ElasticBody: origin", origin, -kMaxPosition, kMaxPosition);
  check_range(
      "ElasticBody: rotation, distance from a rotation matrix",
      (rotation.transpose() * rotation - Mat3::Identity()).norm() + std::abs(rotation.determinant() - 1.0),
      0.0, 1e-6);
  std::vector<Vec3> positions;
  positions.reserve(model->mesh.vertices.size());
  for (const Vec3& v : model->mesh.vertices) {
    positions.push_back(rotation * v + origin);
  }
  return positions;
}

}  // namespace

ElasticBody::ElasticBody(std::shared_ptr<const ElasticModel> model, const Vec3& origin, const Mat3& rotation)
    : Deformable(placed(model.get(), origin, rotation), model->mesh.triangles, model->masses),
      model_(std::move(model)) {
  frame_ = rotation;
  for (std::vector<Vec3>* field :
       {&arms_, &end_arms_, &start_strain_, &start_force_, &shape_velocity_, &inertial_, &strain_, &force_,
        &free_velocities_, &response_velocity_, &pushed_force_}) {
    field->assign(positions_.size(), Vec3::Zero());
  }
  scratch_in_.resize(3 * positions_.size());
  scratch_out_.resize(3 * positions_.size());
  if (!model_->single_response.empty()) {
    single_in_.resize(3 * positions_.size() + kSymmetricPadding);
    single_out_.resize(single_in_.size());
  }
}

ElasticBody::~ElasticBody() = default;

void ElasticBody::set_velocity(const Vec3& linear, const Vec3& angular) {
  check_range("set_velocity: linear", linear, -kMaxSpeed, kMaxSpeed);
  check_range("set_velocity: angular", angular, -kMaxSpin, kMaxSpin);
  const Vec3 center = center_of_mass();
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    velocities_[v] = linear + angular.cross(positions_[v] - center);
  }
  wake();
}

Mat3 ElasticBody::frame() const { return fit_frame(*model_, positions_, center_of_mass()); }

void ElasticBody::displacements(std::vector<double>& out) const {
  const Vec3 center = center_of_mass();
  const Mat3 r = fit_frame(*model_, positions_, center);
  out.resize(3 * positions_.size());
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 d = r.transpose() * (positions_[v] - center) - model_->rest[v];
    std::copy(d.data(), d.data() + 3, out.data() + 3 * v);
  }
}

double ElasticBody::elastic_energy() const {
  std::vector<Vec3> arms = positions_;
  const Vec3 center = center_of_mass();
  for (Vec3& arm : arms) {
    arm -= center;
  }
  return strain_energy_of(arms);
}

// 1/2 d . S d in the frame that fits points at `arms` from their centre of mass.
double ElasticBody::strain_energy_of(const std::vector<Vec3>& arms) const {
  const Mat3 r = fit_frame(*model_, arms, Vec3::Zero());
  const Eigen::Index n = model_->dofs();
  const double* s = model_->stiffness->unit_stiffness.data();
  double sum = 0;
  for (std::size_t v = 0; v < arms.size(); ++v) {
    const Vec3 d = r.transpose() * arms[v] - model_->rest[v];
    for (int axis = 0; axis < 3; ++axis) {
      const double* column = s + (3 * static_cast<Eigen::Index>(v) + axis) * n;
      double force = 0;
      for (std::size_t w = 0; w < arms.size(); ++w) {
        const Vec3 e = r.transpose() * arms[w] - model_->rest[w];
        force += Eigen::Map<const Vec3>(column + 3 * w).dot(e);
      }
      sum += d[axis] * force;
    }
  }
  return 0.5 * model_->material.young * sum;
}

const double* ElasticBody::response() const {
  return own_response_.empty() ? model_->response.data() : own_response_.data();
}

void ElasticBody::choose_response(double dt) {
  dt_ = dt;
  const auto fits = [&](double step) { return std::abs(dt - step) <= 1e-6 * step; };  // btScalar may be float
  const bool own = own_is_due_ || !own_response_.empty();
  if (own && own_is_due_ && fits(own_step_)) {
    compute_response(*model_, own_step_, own_response_);
    own_is_due_ = false;
    ++refactorizations_;
  }
  if (own ? fits(own_step_) : fits(model_->time_step)) {
    return;
  }
  own_is_due_ = false;
  if (fits(model_->time_step)) {
    own_response_.clear();
    return;
  }
  compute_response(*model_, dt, own_response_);
  own_step_ = dt;
  ++refactorizations_;
}

// Those of the rest shape, turned along: a dent does not fold them.
void ElasticBody::skin_normals(std::vector<Vec3>& normals) const {
  normals.resize(positions_.size());
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    normals[v] = frame_ * model_->normals[v];
  }
}

// What the next step begins with; the rest is made in each step.
void ElasticBody::archive_state(StateArchive& archive) {
  archive.constant("Young's modulus", model_->material.young);
  archive.constant("Poisson's ratio", model_->material.poisson);
  archive.constant("time step of the model", model_->time_step);
  archive.constant("hash of the rest shape",
                   state_hash(model_->rest.data(), model_->rest.size() * sizeof(Vec3)));
  archive.number("strain energy", strain_energy_, 0.0);
  archive.rotation("frame", frame_);
  archive.vectors("strain", strain_);
  archive.vectors("elastic force", force_);
  double step = own_is_due_ || !own_response_.empty() ? own_step_ : 0.0;
  archive.number("time step of the response", step, 0.0, 1e6);
  if (!archive.loading()) {
    return;
  }
  if (step == 0.0) {
    own_response_.clear();
    own_is_due_ = false;
  } else if (step != own_step_ || own_response_.empty()) {
    own_step_ = step;
    own_is_due_ = true;
  }
}

// The strain of the state put back is that of the start of the step.
void ElasticBody::restored() {
  frame_ = start_frame_;
  strain_ = start_strain_;
  force_ = start_force_;
  strain_energy_ = start_strain_energy_;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
