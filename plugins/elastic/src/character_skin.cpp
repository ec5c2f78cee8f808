// How forces on a character's skin reach its joints, and displacements of the joints its skin.
#include "character_state.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

Mat3 local_compliance(const SegmentModel& model, int row, int column) {
  const Eigen::Index free = model.free_points();
  Mat3 block;
  for (Eigen::Index a = 0; a < 3; ++a) {
    for (Eigen::Index b = 0; b < 3; ++b) {
      block(a, b) =
          model.free_compliance[static_cast<std::size_t>((b * free + column) * 3 * free + a * free + row)];
    }
  }
  return block;
}

// Rows of Phi^T for one vertex, in the segment's frame.
void Character::State::add_joint_load(const Assembly::Impl& impl, int point, const Vec3& force,
                                      Row load) const {
  const SkinPoint& at = skin[static_cast<std::size_t>(point)];
  if (at.segment < 0) {
    for (Eigen::Index a = 0; a < 3; ++a) load[at.at + a * at.stride] += force[a];
    return;
  }
  const PartGroup& group = impl.groups[static_cast<std::size_t>(at.group)]->group;
  const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(at.segment)];
  const SegmentModel& model = *group.models()[static_cast<std::size_t>(segment.model)]->model;
  const Eigen::Index free = model.free_points(), count = model.joint_points();
  const Eigen::Map<const Eigen::MatrixXd> phi(model.free_response.data(), 3 * free, 3 * count);
  const Vec3 q = segment.rotation.transpose() * force;
  for (Eigen::Index i = 0; i < count; ++i) {
    Vec3 local = Vec3::Zero();
    for (Eigen::Index a = 0; a < 3; ++a) {
      for (Eigen::Index b = 0; b < 3; ++b) local[b] += q[a] * phi(a * free + at.free, b * count + i);
    }
    const Vec3 f = segment.rotation * local;
    const auto k = static_cast<std::size_t>(i);
    for (Eigen::Index a = 0; a < 3; ++a) load[segment.at[k] + a * segment.stride[k]] += f[a];
  }
}

void Character::State::find_row(const Assembly::Impl& impl, int point, Touched& group_touched) const {
  const SkinPoint& at = skin[static_cast<std::size_t>(point)];
  if (at.segment < 0) return;
  const PartGroup& group = impl.groups[static_cast<std::size_t>(at.group)]->group;
  const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(at.segment)];
  const SegmentModel& model = *group.models()[static_cast<std::size_t>(segment.model)]->model;
  const Eigen::Index free = model.free_points(), count = model.joint_points();
  const Eigen::Map<const Eigen::MatrixXd> phi(model.free_response.data(), 3 * free, 3 * count);
  const Eigen::Index first = 3 * slot_of[static_cast<std::size_t>(point)];
  for (Eigen::Index i = 0; i < count; ++i) {
    Mat3 block;
    for (Eigen::Index a = 0; a < 3; ++a) {
      for (Eigen::Index b = 0; b < 3; ++b) block(a, b) = phi(a * free + at.free, b * count + i);
    }
    block = segment.rotation * block * segment.rotation.transpose();
    for (Eigen::Index b = 0; b < 3; ++b) group_touched.rows.block<3, 1>(first, b * count + i) = block.col(b);
  }
}

// One batched product for each model.
void Character::State::shift_skin(Assembly::Impl& impl, std::size_t g, std::vector<Vec3>& points) {
  PartGroup& group = impl.groups[g]->group;
  const Eigen::VectorXd& joints = touched[g].joints;
  for (std::size_t m = 0; m < impl.models.size(); ++m) {
    const PackedModel& packed = *impl.models[m];
    const SegmentModel& model = *packed.model;
    const Eigen::Index depth = packed.free_response.depth(), height = packed.free_response.padded_rows();
    const Eigen::Index count = model.joint_points();
    const auto free = static_cast<std::size_t>(model.free_points());
    Eigen::Index n = 0;
    for (const PartGroup::Segment& segment : group.segments()) {
      if (segment.model != static_cast<int>(m)) continue;
      double* const d = impl.sheet.data() + n++ * depth;
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Vec3 local =
            segment.rotation.transpose() * group.point(joints, segment.at[k], segment.stride[k]);
        for (Eigen::Index a = 0; a < 3; ++a) d[a * count + i] = local[a];
      }
    }
    if (n == 0) continue;
    packed.free_response.multiply(impl.sheet.data(), n, impl.bulge.data(), impl.scratch.data());
    n = 0;
    for (const PartGroup::Segment& segment : group.segments()) {
      if (segment.model != static_cast<int>(m)) continue;
      const double* const u = impl.bulge.data() + n++ * height;
      const std::vector<int>& names = impl.layout.point_of[static_cast<std::size_t>(segment.placed)];
      for (std::size_t i = 0; i < free; ++i) {
        const auto v = static_cast<std::size_t>(model.free_vertices[i]);
        points[static_cast<std::size_t>(names[v])] +=
            segment.rotation * Vec3(u[i], u[free + i], u[2 * free + i]);
      }
    }
  }
  for (std::size_t j = 0; j < group.joints().size(); ++j) {
    const PartGroup::Joint& joint = group.joints()[j];
    const int* const names =
        impl.joint_skin.data() + impl.first_joint_skin[static_cast<std::size_t>(group.joint_ids()[j])];
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      points[static_cast<std::size_t>(names[i])] += group.point(joints, 3 * joint.first + i, joint.count);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
