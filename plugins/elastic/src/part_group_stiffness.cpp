// Stiffness of a group of parts, near the shape of the last evaluation and at rest.
#include <algorithm>

#include "part_group.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

double PartGroup::point_stiffness(std::size_t j) const {
  const Joint& joint = joints_[j];
  double sum = 0;
  for (const int s : joint.segments) {
    if (s < 0) continue;
    const Segment& segment = segments_[static_cast<std::size_t>(s)];
    const SegmentModel& model = *models_[static_cast<std::size_t>(segment.model)]->model;
    const auto count = static_cast<std::size_t>(model.joint_points());
    const auto i = static_cast<std::size_t>(std::find(segment.at.begin(), segment.at.end(), 3 * joint.first) -
                                            segment.at.begin());
    double largest = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t k = a * count + i;
      largest = std::max(largest, model.stiffness[k * 3 * count + k]);
    }
    sum += largest;
  }
  for (const Bone& bone : bones_) {
    if (std::find(bone.at.begin(), bone.at.end(), 3 * joint.first) != bone.at.end()) {
      sum += bone.settings.length_stiffness;
    }
  }
  return sum;
}

void PartGroup::stiffness_product(const Eigen::VectorXd& displacement, Eigen::VectorXd& force) {
  force.setZero();
  for (std::size_t m = 0; m < batches_.size(); ++m) {
    Batch& batch = batches_[m];
    if (batch.segments.empty()) continue;
    const PackedModel& packed = *models_[m];
    const Eigen::Index count = packed.arms.rows(), depth = 3 * count,
                       rows = packed.exact_stiffness.padded_rows();
    for (const int s : batch.segments) {
      const Segment& segment = segments_[static_cast<std::size_t>(s)];
      const Mat3 r = segment.rotation;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3>> d(batch.probes.data() + segment.column * depth,
                                                             count, 3);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Vec3 p = point(displacement, segment.at[static_cast<std::size_t>(i)],
                             segment.stride[static_cast<std::size_t>(i)]);
        d.row(i) = r.transpose() * p;
      }
      if (!batch.turns.empty()) {
        batch.turns[0].turn_change(segment.column, batch.strains.data() + segment.column * depth, d.data());
      }
    }
    packed.exact_stiffness.multiply(batch.probes.data(), static_cast<Eigen::Index>(batch.segments.size()),
                                    batch.forces.data(), scratch_.data());
    products += static_cast<long long>(batch.segments.size());
    for (const int s : batch.segments) {
      const Segment& segment = segments_[static_cast<std::size_t>(s)];
      const Mat3 r = segment.rotation;
      const Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 3>> f(
          batch.forces.data() + segment.column * rows, count, 3);
      if (!batch.turns.empty()) {
        batch.turns[0].turn_forces(segment.column, batch.strains.data() + segment.column * depth,
                                   batch.forces.data() + segment.column * rows);
      }
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
    const std::size_t j1 = joint_at(at1), j2 = joint_at(at2);
    const Eigen::Index p1 = at1 - 3 * joints_[j1].first, p2 = at2 - 3 * joints_[j2].first;
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
    const Eigen::Map<const Eigen::MatrixXd> k(model.stiffness.data(), 3 * count, 3 * count);
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
  each_bone_block(rest_, [&](Eigen::Index a, Eigen::Index b, const Mat3& block) {
    add(a, joints_[joint_at(a)].count, b, joints_[joint_at(b)].count, block);
  });
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
