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

Eigen::Map<const Eigen::MatrixXd> matrix_of(const std::vector<double>& values, Eigen::Index rows) {
  return {values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows};
}

}  // namespace

std::shared_ptr<const PackedModel> pack_model(const SegmentModel& model, const Kernels& kernels,
                                              bool single) {
  auto packed = std::make_shared<PackedModel>();
  const Eigen::Index joint = model.joint_points(), free = model.free_points();
  packed->model = &model;
  packed->stiffness = Product(kernels, matrix_of(model.stiffness, 3 * joint), single);
  packed->free_response = Product(kernels, matrix_of(model.free_response, 3 * free), single);
  for (const int v : model.joint_vertices) {
    packed->mean += model.mesh.vertices[static_cast<std::size_t>(v)] / static_cast<double>(joint);
  }
  packed->arms.resize(joint, 3);
  for (Eigen::Index i = 0; i < joint; ++i) {
    packed->arms.row(i) =
        model.mesh.vertices[static_cast<std::size_t>(model.joint_vertices[static_cast<std::size_t>(i)])] -
        packed->mean;
  }
  packed->first_moment = volume_moment(model.mesh, packed->mean);
  return packed;
}

PartGroup::PartGroup(const AssemblyDesign& design, const PlacedDesign& placed, int group,
                     const std::vector<std::shared_ptr<const PackedModel>>& models)
    : models_(models), batches_(models.size()) {
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
    batches_[m].forces.resize(static_cast<std::size_t>(n * k.padded_rows()));
    scratch = std::max(scratch, k.scratch(n));
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
    stiffness_scale_ =
        std::max(stiffness_scale_,
                 matrix_of(model.stiffness, 3 * model.joint_points()).diagonal().maxCoeff() * spacing_);
  }
}

std::size_t PartGroup::index_of(Eigen::Index at) const {
  const auto next = std::upper_bound(joints_.begin(), joints_.end(), at,
                                     [](Eigen::Index a, const Joint& joint) { return a < 3 * joint.first; });
  return static_cast<std::size_t>(at - 2 * std::prev(next)->first);
}

// d = R^T (x - mean) - X in `local`, axis-major.
void PartGroup::fit(Segment& segment, const Eigen::VectorXd& x, double* local) {
  const auto& arms = models_[static_cast<std::size_t>(segment.model)]->arms;
  const Eigen::Index count = arms.rows();
  LocalPoints d(local, count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index at = segment.at[static_cast<std::size_t>(i)];
    const Eigen::Index stride = segment.stride[static_cast<std::size_t>(i)];
    d(i, 0) = x[at];
    d(i, 1) = x[at + stride];
    d(i, 2) = x[at + 2 * stride];
  }
  segment.mean = d.colwise().mean();
  d.rowwise() -= segment.mean.transpose();
  const Mat3 moment = d.transpose().lazyProduct(arms);
  fit_rotation(moment, segment.rotation, segment.stretch_inverse);
  const Mat3 r = segment.rotation;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double px = d(i, 0), py = d(i, 1), pz = d(i, 2);
    d(i, 0) = r(0, 0) * px + r(1, 0) * py + r(2, 0) * pz - arms(i, 0);
    d(i, 1) = r(0, 1) * px + r(1, 1) * py + r(2, 1) * pz - arms(i, 1);
    d(i, 2) = r(0, 2) * px + r(1, 2) * py + r(2, 2) * pz - arms(i, 2);
  }
}

double PartGroup::evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  gradient.setZero();
  last_ = x;
  double energy = 0, forces = 0;
  elastic_energy_ = 0;
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
    const Eigen::Map<const Eigen::MatrixXd> weight = matrix_of(packed.model->joint_weight, depth);
    const Eigen::Map<const Eigen::MatrixXd> response =
        matrix_of(packed.model->free_response, 3 * packed.model->free_points());
    const Eigen::Index free = packed.model->free_points();
    for (const int s : batch.segments) {
      Segment& segment = segments_[static_cast<std::size_t>(s)];
      LocalPoints d(batch.displacements.data() + segment.column * depth, count, 3);
      LocalPoints f(batch.forces.data() + segment.column * rows, count, 3);
      const Eigen::Map<const Eigen::VectorXd> d_all(d.data(), depth);
      Eigen::Map<Eigen::VectorXd> f_all(f.data(), depth);
      const double strain = 0.5 * d_all.dot(f_all);
      energy += strain;
      elastic_energy_ += strain;
      forces += f_all.squaredNorm();
      Vec3 torque = Vec3::Zero();  // of what hangs on the frame but is no joint force
      if (!gravity.isZero(0)) {
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
      // Change of the frame with the points: tau = sum of x' cross f, f_i -= (A^-1 tau) cross X_i.
      Vec3 tau = -torque;
      for (Eigen::Index i = 0; i < count; ++i) {
        const double xx = d(i, 0) + packed.arms(i, 0), xy = d(i, 1) + packed.arms(i, 1),
                     xz = d(i, 2) + packed.arms(i, 2);
        tau.x() += xy * f(i, 2) - xz * f(i, 1);
        tau.y() += xz * f(i, 0) - xx * f(i, 2);
        tau.z() += xx * f(i, 1) - xy * f(i, 0);
      }
      const Vec3 a = segment.stretch_inverse * tau;
      const Mat3 r = segment.rotation;
      for (Eigen::Index i = 0; i < count; ++i) {
        const double ax = packed.arms(i, 0), ay = packed.arms(i, 1), az = packed.arms(i, 2);
        const double fx = f(i, 0) - (a.y() * az - a.z() * ay);
        const double fy = f(i, 1) - (a.z() * ax - a.x() * az);
        const double fz = f(i, 2) - (a.x() * ay - a.y() * ax);
        const Eigen::Index at = segment.at[static_cast<std::size_t>(i)];
        const Eigen::Index stride = segment.stride[static_cast<std::size_t>(i)];
        gradient[at] += r(0, 0) * fx + r(0, 1) * fy + r(0, 2) * fz;
        gradient[at + stride] += r(1, 0) * fx + r(1, 1) * fy + r(1, 2) * fz;
        gradient[at + 2 * stride] += r(2, 0) * fx + r(2, 1) * fy + r(2, 2) * fz;
      }
    }
  }
  force_scale_ = std::sqrt(forces);
  gradient -= loads;
  energy -= loads.dot(x);
  return energy + bones(x, gradient);
}

void PartGroup::stiffness_product(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) {
  force.setZero();
  for (std::size_t m = 0; m < batches_.size(); ++m) {
    Batch& batch = batches_[m];
    if (batch.segments.empty()) continue;
    const PackedModel& packed = *models_[m];
    const Eigen::Index count = packed.arms.rows(), depth = 3 * count, rows = packed.stiffness.padded_rows();
    for (const int s : batch.segments) {
      const Segment& segment = segments_[static_cast<std::size_t>(s)];
      const Mat3 r = segment.rotation;
      LocalPoints d(batch.probes.data() + segment.column * depth, count, 3);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 p = point(displacement, segment.at[static_cast<std::size_t>(i)],
                             segment.stride[static_cast<std::size_t>(i)]);
        d.row(i) = r.transpose() * p;
      }
    }
    packed.stiffness.multiply(batch.probes.data(), static_cast<Eigen::Index>(batch.segments.size()),
                              batch.forces.data(), scratch_.data());
    products += static_cast<long long>(batch.segments.size());
    for (const int s : batch.segments) {
      const Segment& segment = segments_[static_cast<std::size_t>(s)];
      const Mat3 r = segment.rotation;
      const LocalPoints f(batch.forces.data() + segment.column * rows, count, 3);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 p = r * f.row(i).transpose();
        const Eigen::Index at = segment.at[static_cast<std::size_t>(i)];
        const Eigen::Index stride = segment.stride[static_cast<std::size_t>(i)];
        for (Eigen::Index a = 0; a < 3; ++a) force[at + a * stride] += p[a];
      }
    }
  }
  bone_product(displacement, force);
}

// As in the stiffness of the rest pose, with the bones' present directions.
void PartGroup::bone_product(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) const {
  for (const Bone& bone : bones_) {
    const double k = bone.settings.length_stiffness, c = bone.settings.angle_stiffness;
    if (k == 0.0 && c == 0.0) continue;
    const auto at = [&](const Eigen::VectorXd& v, std::size_t i) {
      return point(v, bone.at[i], bone.stride[i]);
    };
    const auto add = [&](std::size_t i, const Vec3& f) {
      for (Eigen::Index a = 0; a < 3; ++a) force[bone.at[i] + a * bone.stride[i]] += f[a];
    };
    for (std::size_t i = 1; i < bone.at.size(); ++i) {
      const Vec3 edge = at(last_, i) - at(last_, i - 1);
      const Vec3 along = edge / std::max(edge.norm(), 1e-12 * bone.shape.lengths[i - 1]);
      const Vec3 pull = k * along * along.dot(at(displacement, i) - at(displacement, i - 1));
      add(i, pull);
      add(i - 1, -pull);
      if (i < 2 || c == 0.0) continue;
      const double before = bone.shape.lengths[i - 2], after = bone.shape.lengths[i - 1];
      Vec3 bend = (at(displacement, i) - at(displacement, i - 1)) / after -
                  (at(displacement, i - 1) - at(displacement, i - 2)) / before;
      bend = c * (bend - along * along.dot(bend));
      add(i, bend / after);
      add(i - 1, -bend / after - bend / before);
      add(i - 2, bend / before);
    }
  }
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

BlockRows PartGroup::rest_stiffness(const std::vector<char>& held, const Eigen::VectorXd& inertia) const {
  BlockRows rows(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const Eigen::Index n = 3 * joints_[j].count;
    rows[j][j] = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      rows[j][j](i, i) = inertia[joints_[j].first + i % joints_[j].count];
    }
  }
  const auto add = [&](Eigen::Index at1, Eigen::Index stride1, Eigen::Index at2, Eigen::Index stride2,
                       const Mat3& block) {
    // `at` counts 3 first + point; the stride is the joint's count.
    std::size_t j1 = 0, j2 = 0;
    const auto find = [&](Eigen::Index at, std::size_t& j) {
      const auto joint = std::upper_bound(joints_.begin(), joints_.end(), at,
                                          [](Eigen::Index a, const Joint& q) { return a < 3 * q.first; });
      j = static_cast<std::size_t>(joint - joints_.begin()) - 1;
      return at - 3 * joints_[j].first;
    };
    const Eigen::Index p1 = find(at1, j1), p2 = find(at2, j2);
    if (held[static_cast<std::size_t>(joints_[j1].first + p1)] != 0 ||
        held[static_cast<std::size_t>(joints_[j2].first + p2)] != 0) {
      return;
    }
    auto [entry, fresh] =
        rows[j1].try_emplace(j2, Eigen::MatrixXd::Zero(3 * joints_[j1].count, 3 * joints_[j2].count));
    for (Eigen::Index a = 0; a < 3; ++a) {
      for (Eigen::Index b = 0; b < 3; ++b) entry->second(p1 + a * stride1, p2 + b * stride2) += block(a, b);
    }
  };
  for (const Segment& segment : segments_) {
    const SegmentModel& model = *models_[static_cast<std::size_t>(segment.model)]->model;
    const Eigen::Index count = model.joint_points();
    const auto k = matrix_of(model.stiffness, 3 * count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index l = 0; l < count; ++l) {
        Mat3 block;
        for (Eigen::Index a = 0; a < 3; ++a) {
          for (Eigen::Index b = 0; b < 3; ++b) block(a, b) = k(a * count + i, b * count + l);
        }
        const auto si = static_cast<std::size_t>(i), sl = static_cast<std::size_t>(l);
        add(segment.at[si], segment.stride[si], segment.at[sl], segment.stride[sl],
            segment.rest_rotation * block * segment.rest_rotation.transpose());
      }
    }
  }
  // Bones near rest: k t t^T along each, and c times the square of the change of direction at each joint.
  for (const Bone& bone : bones_) {
    const double k = bone.settings.length_stiffness, c = bone.settings.angle_stiffness;
    const auto node = [&](std::size_t i) { return point(rest_, bone.at[i], bone.stride[i]); };
    const auto link = [&](std::size_t i, std::size_t l, const Mat3& block) {
      add(bone.at[i], bone.stride[i], bone.at[l], bone.stride[l], block);
    };
    for (std::size_t i = 1; i < bone.at.size(); ++i) {
      const Vec3 along = (node(i) - node(i - 1)).normalized();
      const Mat3 stretch = k * along * along.transpose();
      link(i, i, stretch);
      link(i - 1, i - 1, stretch);
      link(i, i - 1, -stretch);
      link(i - 1, i, -stretch);
      if (i < 2 || c == 0.0) continue;
      const double before = bone.shape.lengths[i - 2], after = bone.shape.lengths[i - 1];
      const std::array<double, 3> weight = {1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after};
      const Mat3 across = Mat3::Identity() - along * along.transpose();
      for (std::size_t p = 0; p < 3; ++p) {
        for (std::size_t q = 0; q < 3; ++q) link(i - 2 + p, i - 2 + q, c * weight[p] * weight[q] * across);
      }
    }
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    for (Eigen::Index i = 0; i < joints_[j].count; ++i) {
      if (held[static_cast<std::size_t>(joints_[j].first + i)] == 0) continue;
      for (Eigen::Index a = 0; a < 3; ++a) {
        const Eigen::Index row = i + a * joints_[j].count;
        rows[j][j](row, row) = 1.0;
      }
    }
  }
  return rows;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
