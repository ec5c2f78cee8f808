#include "part_group.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "rotation_fit.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using LocalPoints = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3>>;

Eigen::Map<const Eigen::MatrixXd> matrix_of(const std::vector<double>& values, Eigen::Index rows,
                                            Eigen::Index columns) {
  return {values.data(), rows, columns};
}

}  // namespace

std::size_t PartGroup::joint_at(Eigen::Index at) const {
  const auto next = std::upper_bound(joints_.begin(), joints_.end(), at,
                                     [](Eigen::Index a, const Joint& joint) { return a < 3 * joint.first; });
  return static_cast<std::size_t>(next - joints_.begin()) - 1;
}

std::size_t PartGroup::index_of(Eigen::Index at) const {
  return static_cast<std::size_t>(at - 2 * joints_[joint_at(at)].first);
}

// (J2): d = R^T (x - mean) - X in `local`, axis-major.
void PartGroup::fit(Segment& segment, const Eigen::VectorXd& x, double* local) {
  const auto& arms = models_[static_cast<std::size_t>(segment.model)]->arms;
  const Eigen::Index count = arms.rows();
  // From the first point, for rounding far from the origin.
  const Vec3 first = point(x, segment.at.front(), segment.stride.front());
  double* const p = gathered_.data();
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = segment.at[static_cast<std::size_t>(i)];
    const Eigen::Index stride = segment.stride[static_cast<std::size_t>(i)];
    p[i] = x[at] - first.x();
    p[count + i] = x[at + stride] - first.y();
    p[2 * count + i] = x[at + 2 * stride] - first.z();
  }
  double sums[12];
  kernels_.sum_moments(p, arms.data(), count, sums);
  const Vec3 mean = Eigen::Map<const Vec3>(sums) / static_cast<double>(count);
  // Arms have no mean: the moment is the same about any point.
  fit_rotation(Eigen::Map<const Mat3>(sums + 3), segment.rotation, segment.stretch_inverse);
  kernels_.turn_back(p, mean.data(), segment.rotation.data(), arms.data(), count, local);
  segment.mean = first + mean;
}

void PartGroup::fit_all(const Eigen::VectorXd& x) {
  for (Segment& segment : segments_) {
    const auto m = static_cast<std::size_t>(segment.model);
    fit(segment, x, batches_[m].displacements.data() + segment.column * 3 * models_[m]->arms.rows());
  }
}

double PartGroup::evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  gradient.setZero();
  last_ = x;
  double energy = 0, forces = 0;
  elastic_energy_ = energy_scale_ = 0;
  for (std::size_t m = 0; m < batches_.size(); ++m) {
    Batch& batch = batches_[m];
    if (batch.segments.empty()) continue;
    const PackedModel& packed = *models_[m];
    const bool turned = !batch.turns.empty();
    const Eigen::Index count = packed.arms.rows(), depth = 3 * count, rows = packed.stiffness.padded_rows();
    for (const int s : batch.segments) {
      Segment& segment = segments_[static_cast<std::size_t>(s)];
      double* const d = batch.displacements.data() + segment.column * depth;
      fit(segment, x, d);
      if (turned) batch.turns[0].straighten(segment.column, d, batch.strains.data() + segment.column * depth);
    }
    const std::vector<double>& strains = turned ? batch.strains : batch.displacements;
    packed.stiffness.multiply(strains.data(), static_cast<Eigen::Index>(batch.segments.size()),
                              batch.forces.data(), scratch_.data());
    products += static_cast<long long>(batch.segments.size());
    const Eigen::Map<const Eigen::MatrixXd> weight = matrix_of(packed.model->joint_weight, depth, 3);
    const Eigen::Map<const Eigen::MatrixXd> response =
        matrix_of(packed.model->free_response, 3 * packed.model->free_points(), depth);
    const Eigen::Index free = packed.model->free_points();
    for (const int s : batch.segments) {
      Segment& segment = segments_[static_cast<std::size_t>(s)];
      LocalPoints d(batch.displacements.data() + segment.column * depth, count, 3);
      LocalPoints f(batch.forces.data() + segment.column * rows, count, 3);
      const Eigen::Map<const Eigen::VectorXd> d_all(d.data(), depth);
      Eigen::Map<Eigen::VectorXd> f_all(f.data(), depth);
      double sums[5];
      const double* const strained = strains.data() + segment.column * depth;
      kernels_.sum_forces(strained, f.data(), packed.arms.data(), count, sums);
      const double strain = 0.5 * sums[0];
      energy += strain;
      elastic_energy_ += strain;
      energy_scale_ += d_all.squaredNorm();
      forces += sums[1];
      Vec3 torque = Vec3::Zero();  // of what hangs on the frame but is no joint force
      bool loaded = turned;
      if (turned) batch.turns[0].turn_forces(segment.column, strained, f.data());
      if (!gravity.isZero(0)) {
        loaded = true;
        // -b . integral of x over the volume, b in the frame.
        const Vec3 b = packed.model->material.density * (segment.rotation.transpose() * gravity);
        const Vec3 moment = packed.first_moment + weight.transpose() * d_all;
        energy -=
            b.dot(moment) + packed.model->volume * packed.model->material.density * gravity.dot(segment.mean);
        f_all.noalias() -= weight * b;
        torque += b.cross(moment);
      }
      for (const SkinPush& push : pushes) {
        if (push.segment != s) continue;
        loaded = true;
        const Vec3 q = segment.rotation.transpose() * push.force;
        Vec3 at = packed.model->mesh.vertices[static_cast<std::size_t>(
                      packed.model->free_vertices[static_cast<std::size_t>(push.free_point)])] -
                  packed.mean;
        for (Eigen::Index a = 0; a < 3; ++a) {
          const auto row = response.row(a * free + push.free_point);
          at[a] += row.dot(d_all);
          f_all.noalias() -= q[a] * row.transpose();
        }
        energy -= push.force.dot(segment.mean) + q.dot(at);
        torque += q.cross(at);
      }
      // (J3), change of the frame with the points; turns and loads have changed f.
      if (loaded) kernels_.sum_forces(d.data(), f.data(), packed.arms.data(), count, sums);
      const Vec3 a = segment.stretch_inverse * (Eigen::Map<const Vec3>(sums + 2) - torque);
      kernels_.turn_forces(f.data(), a.data(), segment.rotation.data(), packed.arms.data(), count);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Eigen::Index at = segment.at[static_cast<std::size_t>(i)];
        const Eigen::Index stride = segment.stride[static_cast<std::size_t>(i)];
        gradient[at] += f(i, 0);
        gradient[at + stride] += f(i, 1);
        gradient[at + 2 * stride] += f(i, 2);
      }
    }
  }
  energy_scale_ *= stiffness_scale_ / spacing_;
  force_scale_ = std::sqrt(forces);
  gradient -= loads;
  energy -= loads.dot(x);
  return energy + bones(x, gradient);
}

double PartGroup::bones(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  double energy = 0;
  for (const Bone& bone : bones_) {
    if (bone.settings.length_stiffness == 0.0 && bone.settings.angle_stiffness == 0.0) continue;
    const std::size_t n = bone.at.size();
    for (std::size_t i = 0; i < n; ++i) {
      bone_points_[i] = point(x, bone.at[i], bone.stride[i]);
      bone_gradient_[i].setZero();
    }
    energy += bone_energy(bone.settings, bone.shape, {bone_points_.data(), n}, {bone_gradient_.data(), n});
    for (std::size_t i = 0; i < n; ++i) {
      for (Eigen::Index a = 0; a < 3; ++a) gradient[bone.at[i] + a * bone.stride[i]] += bone_gradient_[i][a];
    }
  }
  return energy;
}

double PartGroup::largest_turn() const {
  double least = 3.0;  // trace of the turn: 1 + 2 cos
  for (const Joint& joint : joints_) {
    if (joint.segments[1] < 0) continue;
    const Segment& a = segments_[static_cast<std::size_t>(joint.segments[0])];
    const Segment& b = segments_[static_cast<std::size_t>(joint.segments[1])];
    const Mat3 turn = a.rotation * a.rest_rotation.transpose() * b.rest_rotation * b.rotation.transpose();
    least = std::min(least, turn.trace());
  }
  return std::acos(std::clamp(0.5 * (least - 1.0), -1.0, 1.0));
}

void PartGroup::update_turns() {
  for (Joint& joint : joints_) {
    const auto turn_of = [&](int s) -> Mat3 {
      const Segment& segment = segments_[static_cast<std::size_t>(s)];
      return segment.rotation * segment.rest_rotation.transpose();
    };
    joint.turn = turn_of(joint.segments[0]);
    if (joint.segments[1] < 0) continue;
    // Half way between the two: the bisector of the joint.
    const Eigen::Quaterniond first(joint.turn), second(turn_of(joint.segments[1]));
    const double sign = first.dot(second) < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector4d sum = first.coeffs() + sign * second.coeffs();
    joint.turn = Eigen::Quaterniond(sum).normalized().toRotationMatrix();
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
