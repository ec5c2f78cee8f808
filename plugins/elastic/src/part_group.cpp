#include "part_group.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "rotation_fit.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

using LocalPoints = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3>>;

Vec3 volume_moment(const TriangleMesh& mesh, const Vec3& origin) {
  Vec3 moment = Vec3::Zero();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[static_cast<std::size_t>(t[0])] - origin;
    const Vec3 b = mesh.vertices[static_cast<std::size_t>(t[1])] - origin;
    const Vec3 c = mesh.vertices[static_cast<std::size_t>(t[2])] - origin;
    moment += a.dot(b.cross(c)) / 24.0 * (a + b + c);
  }
  return moment;
}

Eigen::Map<const Eigen::MatrixXd> matrix_of(const std::vector<double>& values, Eigen::Index rows,
                                            Eigen::Index columns) {
  return {values.data(), rows, columns};
}

}  // namespace

std::shared_ptr<const PackedModel> pack_model(const SegmentModel& model, const Kernels& kernels,
                                              bool single) {
  auto packed = std::make_shared<PackedModel>();
  const Eigen::Index joint = model.joint_points(), free = model.free_points();
  packed->model = &model;
  packed->kernels = &kernels;
  packed->stiffness = Product(kernels, matrix_of(model.stiffness, 3 * joint, 3 * joint), single);
  packed->exact_stiffness =
      single ? Product(kernels, matrix_of(model.stiffness, 3 * joint, 3 * joint), false) : packed->stiffness;
  packed->free_response = Product(kernels, matrix_of(model.free_response, 3 * free, 3 * joint), single);
  for (const int v : model.joint_vertices) {
    packed->mean += model.mesh.vertices[static_cast<std::size_t>(v)] / static_cast<double>(joint);
  }
  packed->arms.resize(joint, 3);
  for (Eigen::Index i = 0; i < joint; ++i) {
    packed->arms.row(i) =
        model.mesh.vertices[static_cast<std::size_t>(model.joint_vertices[static_cast<std::size_t>(i)])] -
        packed->mean;
  }
  packed->free_rest.resize(free, 3);
  for (Eigen::Index i = 0; i < free; ++i) {
    packed->free_rest.row(i) =
        model.mesh.vertices[static_cast<std::size_t>(model.free_vertices[static_cast<std::size_t>(i)])];
  }
  packed->first_moment = volume_moment(model.mesh, packed->mean);
  return packed;
}

PartGroup::PartGroup(const AssemblyDesign& design, const PlacedDesign& placed, int group,
                     const std::vector<std::shared_ptr<const PackedModel>>& models)
    : models_(models), batches_(models.size()), kernels_(*models.front()->kernels) {
  std::vector<int> local(placed.joints.size(), -1);
  for (std::size_t j = 0; j < placed.joints.size(); ++j) {
    if (placed.joints[j].group != group) continue;
    local[j] = static_cast<int>(joints_.size());
    joint_ids_.push_back(static_cast<int>(j));
    const auto count = static_cast<Eigen::Index>(placed.joints[j].rest.size());
    joints_.push_back({points_, count, Mat3::Identity(), {-1, -1}});
    points_ += count;
  }
  rest_.resize(3 * points_);
  last_.setZero(3 * points_);
  loads.setZero(3 * points_);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const std::vector<Vec3>& rest = placed.joints[static_cast<std::size_t>(joint_ids_[j])].rest;
    for (Eigen::Index i = 0; i < joints_[j].count; ++i) {
      for (Eigen::Index a = 0; a < 3; ++a) {
        rest_[3 * joints_[j].first + a * joints_[j].count + i] = rest[static_cast<std::size_t>(i)][a];
      }
    }
  }
  for (std::size_t s = 0; s < placed.segments.size(); ++s) {
    const PlacedSegment& from = placed.segments[s];
    if (placed.joints[static_cast<std::size_t>(from.joint.front())].group != group) continue;
    Segment segment;
    segment.placed = static_cast<int>(s);
    segment.model = static_cast<int>(
        std::find_if(models.begin(), models.end(), [&](const auto& m) { return m->model == from.model; }) -
        models.begin());
    Batch& batch = batches_[static_cast<std::size_t>(segment.model)];
    segment.column = static_cast<int>(batch.segments.size());
    batch.segments.push_back(static_cast<int>(segments_.size()));
    segment.rest_rotation = segment.rotation = from.rotation;
    for (std::size_t i = 0; i < from.joint.size(); ++i) {
      const PlacedJoint& meeting = placed.joints[static_cast<std::size_t>(from.joint[i])];
      Joint& joint = joints_[static_cast<std::size_t>(local[static_cast<std::size_t>(from.joint[i])])];
      joint.segments[joint.segments[0] < 0 ? 0 : 1] = static_cast<int>(segments_.size());
      const auto side =
          static_cast<std::size_t>(std::find(meeting.interfaces.begin(), meeting.interfaces.end(),
                                             std::array<int, 2>{static_cast<int>(s), static_cast<int>(i)}) -
                                   meeting.interfaces.begin());
      for (const int point : meeting.order[side]) {
        segment.at.push_back(3 * joint.first + point);
        segment.stride.push_back(joint.count);
      }
    }
    segments_.push_back(std::move(segment));
  }
  std::size_t scratch = 0;
  for (std::size_t m = 0; m < models_.size(); ++m) {
    const auto n = static_cast<Eigen::Index>(batches_[m].segments.size());
    const Product& k = models_[m]->stiffness;
    batches_[m].displacements.resize(static_cast<std::size_t>(n * k.depth()));
    batches_[m].probes.resize(static_cast<std::size_t>(n * k.depth()));
    batches_[m].forces.resize(
        static_cast<std::size_t>(n * std::max(k.padded_rows(), models_[m]->exact_stiffness.padded_rows())));
    scratch = std::max(scratch, k.scratch(n));
    gathered_.resize(std::max(gathered_.size(), static_cast<std::size_t>(k.depth())));
  }
  scratch_.resize(scratch);

  std::size_t longest = 0;
  int edges = 0;
  for (std::size_t p = 0; p < placed.part_joints.size(); ++p) {
    const std::vector<int>& row = placed.part_joints[p];
    if (placed.joints[static_cast<std::size_t>(row.front())].group != group) continue;
    Bone bone;
    bone.part = static_cast<int>(p);
    bone.settings = design.parts[p].bone;
    std::vector<Vec3> at_rest;
    for (const int j : row) {
      const Joint& joint = joints_[static_cast<std::size_t>(local[static_cast<std::size_t>(j)])];
      // An end joined to a patch keeps its own order of points: the first lies on the bone.
      bone.at.push_back(3 * joint.first);
      bone.stride.push_back(joint.count);
      at_rest.push_back(placed.joints[static_cast<std::size_t>(j)].rest.front());
    }
    bone.shape = bone_shape(at_rest);
    for (const double length : bone.shape.lengths) {
      spacing_ += length;
      ++edges;
    }
    longest = std::max(longest, row.size());
    bones_.push_back(std::move(bone));
  }
  spacing_ /= edges;
  bone_points_.resize(longest);
  bone_gradient_.resize(longest);
  for (const Segment& segment : segments_) {
    const SegmentModel& model = *models_[static_cast<std::size_t>(segment.model)]->model;
    stiffness_scale_ = std::max(
        stiffness_scale_,
        matrix_of(model.stiffness, 3 * model.joint_points(), 3 * model.joint_points()).diagonal().maxCoeff() *
            spacing_);
  }
}

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
    const Eigen::Index count = packed.arms.rows(), depth = 3 * count, rows = packed.stiffness.padded_rows();
    for (const int s : batch.segments) {
      Segment& segment = segments_[static_cast<std::size_t>(s)];
      fit(segment, x, batch.displacements.data() + segment.column * depth);
    }
    packed.stiffness.multiply(batch.displacements.data(), static_cast<Eigen::Index>(batch.segments.size()),
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
      kernels_.sum_forces(d.data(), f.data(), packed.arms.data(), count, sums);
      const double strain = 0.5 * sums[0];
      energy += strain;
      elastic_energy_ += strain;
      energy_scale_ += d_all.squaredNorm();
      forces += sums[1];
      Vec3 torque = Vec3::Zero();  // of what hangs on the frame but is no joint force
      bool loaded = false;
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
      // (J3), change of the frame with the points; loads have changed f.
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
