// Loads on points, implicit in the step (L1 to L5 in doc/elastic_dynamics.md).
#include <Eigen/Geometry>

#include <algorithm>

#include "instruction_set.h"
#include "point_loads.h"
#include "softpoint/elastic/elastic_body.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void ElasticBody::set_point_loads(std::span<const int> points, std::span<const Vec3> forces,
                                  std::span<const double> stiffness) {
  if (loads_ == nullptr) {
    auto loads = std::make_unique<PointLoads>(kernels_for(model_->stiffness->instruction_set));
    loads->set(points, forces, stiffness, positions_.size());
    loads_ = std::move(loads);
    rest_inverse_inertia_ = inverse_inertia(model_->rest);
  } else {
    loads_->set(points, forces, stiffness, positions_.size());
  }
  if (asleep() && loads_->differ_from_applied(points, forces)) {
    wake();
  }
}

void ElasticBody::clear_point_loads() {
  if (!loaded()) {
    return;
  }
  loads_->clear();
  if (asleep() && loads_->differ_from_applied({}, {})) {
    wake();
  }
}

std::span<const Vec3> ElasticBody::point_load_forces() const {
  return loads_ != nullptr ? std::span<const Vec3>(loads_->end_forces) : std::span<const Vec3>();
}

bool ElasticBody::loaded() const { return loads_ != nullptr && loads_->active(); }

bool ElasticBody::has_springs() const { return loaded() && loads_->rank() > 0; }

// Velocity of point i per impulse on point j, without what moves the body as a whole: B~, in frame R.
Mat3 ElasticBody::shape_response(int i, int j) const {
  const Eigen::Index n = model_->dofs();
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  const Vec3& xi = model_->rest[static_cast<std::size_t>(i)];
  const Vec3& xj = model_->rest[static_cast<std::size_t>(j)];
  Mat3 block = b.block<3, 3>(3 * i, 3 * j);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit = Vec3::Unit(axis);
    block.col(axis) -= unit / total_mass() + (rest_inverse_inertia_ * xj.cross(unit)).cross(xi);
  }
  return block;
}

// Stage 4b. The shape answers with B less its rigid motions; the body as a whole with the momentum and the
// torque of the loads, counted where the rigid motion carries the points of the start.
void ElasticBody::carry_loads() {
  PointLoads& l = *loads_;
  l.applied_points.assign(l.points.begin(), l.points.end());
  l.applied.assign(l.forces.begin(), l.forces.end());
  l.frame = frame_;
  const Mat3 turn = frame_.transpose() * turn_;
  const int count = l.count();
  const auto vertex = [&](int i) { return static_cast<std::size_t>(l.points[static_cast<std::size_t>(i)]); };
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < count; ++i) {
      l.compliance.block<3, 3>(3 * i, 3 * j) =
          shape_response(static_cast<int>(vertex(i)), static_cast<int>(vertex(j)));
    }
    l.impulse.segment<3>(3 * j) = dt_ * (turn * l.forces[static_cast<std::size_t>(j)]);
  }
  l.turn_springs(arms_, turn);
  l.factor(dt_);
  if (l.rank() > 0) {
    l.motion.noalias() = l.compliance * l.impulse;
    l.motion *= dt_;
    for (int i = 0; i < count; ++i) {
      l.motion.segment<3>(3 * i) += model_->rest[vertex(i)] + strain_[vertex(i)] - turn * arms_[vertex(i)];
    }
    l.solve(l.motion);
    l.take_springs(dt_, l.impulse);
  }
  Vec3 push = Vec3::Zero(), twist = Vec3::Zero();
  for (int i = 0; i < count; ++i) {
    const Vec3 impulse = frame_ * l.impulse.segment<3>(3 * i);
    push += impulse;
    twist += (turn_ * arms_[vertex(i)]).cross(impulse);
  }
  // The shape; force_ as in respond().
  std::fill(response_velocity_.begin(), response_velocity_.end(), Vec3::Zero());
  pushed_force_ = force_;
  add_shape_response(l.impulse.data());
  strain_energy_ = 0.0;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    strain_[v] += dt_ * response_velocity_[v];
    force_[v] = pushed_force_[v];
    strain_energy_ += 0.5 * strain_[v].dot(force_[v]);
  }
  // The body.
  const Mat3 inverse = turn_ * inverse_inertia_ * turn_.transpose();
  energy_at_start_ += twist.dot(inverse * (spin_ + 0.5 * twist));
  spin_ += twist;
  center_velocity_ += push / total_mass();
  const Vec3 rotation = dt_ * (inverse * twist);
  if (const double angle = rotation.norm(); angle > 0.0) {
    frame_ = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix() * frame_;
  }
  const Vec3 end_center = start_center_ + dt_ * center_velocity_;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    end_positions_[v] = end_center + frame_ * (model_->rest[v] + strain_[v]);
  }
  l.reaction.setZero();
  note_load_forces();
}

// Adds the answer to response_velocity_, without its rigid motion, and to pushed_force_.
void ElasticBody::add_shape_response(const double* impulses) {
  const PointLoads& l = *loads_;
  const Eigen::Index n = model_->dofs();
  const Eigen::Map<const Eigen::MatrixXd> b(response(), n, n);
  Eigen::Map<Eigen::VectorXd> out(scratch_out_.data(), n);
  out.setZero();
  Vec3 push = Vec3::Zero(), twist = Vec3::Zero();
  for (Eigen::Index j = 0; j < l.count(); ++j) {
    const Eigen::Map<const Vec3> local(impulses + 3 * j);
    const int p = l.points[static_cast<std::size_t>(j)];
    for (int axis = 0; axis < 3; ++axis) {
      out += local[axis] * b.col(3 * p + axis);
    }
    push += local;
    twist += model_->rest[static_cast<std::size_t>(p)].cross(local);
  }
  const Vec3 velocity = push / total_mass(), omega = rest_inverse_inertia_ * twist;
  for (std::size_t v = 0; v < positions_.size(); ++v) {
    const Vec3 moved = out.segment<3>(static_cast<Eigen::Index>(3 * v));
    pushed_force_[v] -= masses_[v] / dt_ * moved;
    response_velocity_[v] += moved - velocity - omega.cross(model_->rest[v]);
  }
  for (Eigen::Index j = 0; j < l.count(); ++j) {
    pushed_force_[static_cast<std::size_t>(l.points[static_cast<std::size_t>(j)])] +=
        Eigen::Map<const Vec3>(impulses + 3 * j) / dt_;
  }
}

void ElasticBody::note_load_forces() {
  PointLoads& l = *loads_;
  l.end_forces.resize(l.points.size());
  for (std::size_t i = 0; i < l.points.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(3 * i);
    l.end_forces[i] = l.frame * (l.impulse.segment<3>(k) + l.reaction.segment<3>(k)) / dt_;
  }
}

// J, done by the loads on the change of shape (the energy a step may gain by them).
double ElasticBody::work_of_loads() const {
  double work = 0.0;
  for (std::size_t i = 0; i < loads_->points.size(); ++i) {
    const Vec3 local = loads_->impulse.segment<3>(static_cast<Eigen::Index>(3 * i));
    work += (loads_->frame * local).dot(shape_velocity_[static_cast<std::size_t>(loads_->points[i])]);
  }
  return work;
}

// The springs of the loads hold back what impulses from outside move: C - C_tl W C_lt (L5).
void ElasticBody::stiffen(std::span<const int> touched, double* blocks) {
  PointLoads& l = *loads_;
  const auto rows = static_cast<Eigen::Index>(3 * touched.size());
  l.touched_rows.resize(static_cast<std::size_t>(rows * l.rank()));
  Eigen::Map<Eigen::MatrixXd> y(l.touched_rows.data(), rows, l.rank());
  y.setZero();
  for (std::size_t i = 0; i < touched.size(); ++i) {
    for (std::size_t j = 0; j < l.points.size(); ++j) {
      const Mat3 block = dt_ * shape_response(touched[i], l.points[j]);
      for (Eigen::Index k = 0; k < l.rank(); ++k) {
        y.col(k).segment<3>(static_cast<Eigen::Index>(3 * i)) +=
            block * l.springs.col(k).segment<3>(static_cast<Eigen::Index>(3 * j));
      }
    }
  }
  l.divide(y.data(), rows);
  Eigen::Map<Eigen::MatrixXd> result(blocks, rows, rows);
  for (Eigen::Index i = 0; i < rows; i += 3) {
    for (Eigen::Index k = 0; k < l.rank(); ++k) {
      const Vec3 turned = frame_ * y.col(k).segment<3>(i);
      y.col(k).segment<3>(i) = turned;
    }
  }
  for (Eigen::Index k = 0; k < l.rank(); ++k) {
    for (Eigen::Index j = 0; j < rows; ++j) {
      result.col(j) -= y(j, k) * y.col(k);
    }
  }
}

// The loads' answer to impulses from outside: -h springs A^-1 springs^T h C_lt J, which has neither
// momentum nor spin.
void ElasticBody::react(std::span<const int> touched, std::span<const Vec3> impulses) {
  PointLoads& l = *loads_;
  l.motion.setZero();
  for (std::size_t j = 0; j < touched.size(); ++j) {
    const Vec3 local = frame_.transpose() * impulses[j];
    for (std::size_t i = 0; i < l.points.size(); ++i) {
      l.motion.segment<3>(static_cast<Eigen::Index>(3 * i)) +=
          dt_ * (shape_response(l.points[i], touched[j]) * local);
    }
  }
  l.solve(l.motion);
  l.reaction.setZero();
  l.take_springs(dt_, l.reaction);
  add_shape_response(l.reaction.data());
  note_load_forces();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
