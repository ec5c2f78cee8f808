// The skin of an assembly from its joints, and what can be measured on it.
#include <Eigen/Geometry>

#include <algorithm>
#include <map>

#include "assembly_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void Assembly::Impl::reserve_skin() {
  for (const auto& state : groups) shifted.resize(std::max(shifted.size(), state->group.segments().size()));
  for (std::size_t m = 0; m < models.size(); ++m) {
    Eigen::Index most = 0;
    for (const auto& state : groups) {
      const auto& segments = state->group.segments();
      most = std::max(
          most, static_cast<Eigen::Index>(std::count_if(segments.begin(), segments.end(), [&](const auto& s) {
            return s.model == static_cast<int>(m);
          })));
    }
    const Product& product = models[m]->free_response;
    sheet.resize(std::max(sheet.size(), static_cast<std::size_t>(most * product.depth())));
    bulge.resize(std::max(bulge.size(), static_cast<std::size_t>(most * product.padded_rows())));
    scratch.resize(std::max(scratch.size(), product.scratch(most)));
    dirty.reserve(static_cast<std::size_t>(most));
  }
}

// Segments none of whose joint points has shifted keep their skin.
void Assembly::Impl::skin(GroupState& state) {
  PartGroup& group = state.group;
  std::fill_n(shifted.begin(), group.segments().size(), state.skin_changed ? 1 : 0);
  for (const PartGroup::Joint& joint : group.joints()) {
    const double* const now = state.x.data() + 3 * joint.first;
    if (std::equal(now, now + 3 * joint.count, state.skinned.data() + 3 * joint.first)) continue;
    for (const int s : joint.segments) {
      if (s >= 0) shifted[static_cast<std::size_t>(s)] = 1;
    }
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    const PackedModel& packed = *models[m];
    const SegmentModel& model = *packed.model;
    const Eigen::Index depth = packed.free_response.depth(), rows = packed.free_response.padded_rows();
    const double* const displacements = group.displacements(static_cast<int>(m)).data();
    dirty.clear();
    bool all = true;
    for (std::size_t s = 0; s < group.segments().size(); ++s) {
      const PartGroup::Segment& segment = group.segments()[s];
      if (segment.model != static_cast<int>(m)) continue;
      if (shifted[s] != 0) dirty.push_back(static_cast<int>(s));
      all = all && shifted[s] != 0;
    }
    if (dirty.empty()) continue;
    report.segments_skinned += static_cast<int>(dirty.size());
    // Those that shifted, side by side; all of them are already.
    for (std::size_t k = 0; k < dirty.size() && !all; ++k) {
      const double* const d =
          displacements + group.segments()[static_cast<std::size_t>(dirty[k])].column * depth;
      std::copy(d, d + depth, sheet.begin() + static_cast<std::ptrdiff_t>(k) * depth);
    }
    const double* const columns = all ? displacements : sheet.data();
    const auto count = static_cast<Eigen::Index>(dirty.size());
    // Nothing to be added: straight from the precision of the product.
    const float* const singles = group.gravity.isZero(0) && group.pushes.empty()
                                     ? packed.free_response.multiply_single(columns, count, scratch.data())
                                     : nullptr;
    if (singles == nullptr) packed.free_response.multiply(columns, count, bulge.data(), scratch.data());
    for (std::size_t k = 0; k < dirty.size(); ++k) {
      const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(dirty[k])];
      const Vec3 at = segment.mean - segment.rotation * packed.mean;
      const int first = layout.first_free[static_cast<std::size_t>(segment.placed)];
      double* const out = points[static_cast<std::size_t>(first)].data();
      const Eigen::Index column = static_cast<Eigen::Index>(k) * rows;
      if (singles != nullptr) {
        kernels->place_single_points(packed.free_rest.data(), singles + column, segment.rotation.data(),
                                     at.data(), model.free_points(), out);
        continue;
      }
      double* const u = bulge.data() + column;
      add_loads(group, dirty[k], packed, u);
      kernels->place_points(packed.free_rest.data(), u, segment.rotation.data(), at.data(),
                            model.free_points(), out);
    }
  }
  for (std::size_t j = 0; j < group.joints().size(); ++j) {
    const PartGroup::Joint& joint = group.joints()[j];
    const int* const names =
        joint_skin.data() + first_joint_skin[static_cast<std::size_t>(group.joint_ids()[j])];
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      points[static_cast<std::size_t>(names[i])] = group.point(state.x, 3 * joint.first + i, joint.count);
    }
  }
  state.skinned = state.x;
  state.skin_changed = false;
}

// Sag under gravity and dents under pushes, on top of what the joints do to the skin.
void Assembly::Impl::add_loads(const PartGroup& group, int segment, const PackedModel& packed,
                               double* u) const {
  const SegmentModel& model = *packed.model;
  const Eigen::Index rows = 3 * model.free_points();
  const Mat3 r = group.segments()[static_cast<std::size_t>(segment)].rotation;
  Eigen::Map<Eigen::VectorXd> bulging(u, rows);
  if (!group.gravity.isZero(0)) {
    const Vec3 b = model.material.density * (r.transpose() * group.gravity);
    bulging.noalias() += Eigen::Map<const Eigen::MatrixXd>(model.free_sag.data(), rows, 3) * b;
  }
  for (const SkinPush& push : group.pushes) {
    if (push.segment != segment) continue;
    const Vec3 q = r.transpose() * push.force;
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Eigen::Index column = a * model.free_points() + push.free_point;
      bulging.noalias() +=
          q[a] * Eigen::Map<const Eigen::VectorXd>(model.free_compliance.data() + column * rows, rows);
    }
  }
}

namespace {

// Angle between the faces on both sides of each edge of the skin that lies on a joining surface.
double largest_kink(const std::vector<Vec3>& points, const std::vector<Triangle>& faces,
                    const std::vector<char>& rim) {
  std::map<std::pair<int, int>, std::size_t> first;
  double largest = 0;
  const auto normal = [&](std::size_t f) {
    const Vec3& a = points[static_cast<std::size_t>(faces[f][0])];
    return Vec3((points[static_cast<std::size_t>(faces[f][1])] - a)
                    .cross(points[static_cast<std::size_t>(faces[f][2])] - a));
  };
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = faces[f][k], b = faces[f][(k + 1) % 3];
      if (rim[static_cast<std::size_t>(a)] == 0 || rim[static_cast<std::size_t>(b)] == 0) continue;
      const auto [entry, fresh] = first.try_emplace(std::minmax(a, b), f);
      if (fresh) continue;
      const Vec3 n = normal(f), o = normal(entry->second);
      largest = std::max(largest, std::atan2(n.cross(o).norm(), n.dot(o)));
    }
  }
  return largest;
}

}  // namespace

JointQuality Assembly::quality() const {
  std::vector<char> rim(impl_->points.size(), 0);
  for (std::size_t j = 0; j < impl_->placed.joints.size(); ++j) {
    const PlacedJoint& joint = impl_->placed.joints[j];
    if (joint.interfaces.size() < 2) continue;
    for (std::size_t i = 0; i < joint.rest.size(); ++i) {
      rim[static_cast<std::size_t>(
          impl_->joint_skin[static_cast<std::size_t>(impl_->first_joint_skin[j]) + i])] = 1;
    }
  }
  JointQuality quality;
  // Each segment's own idea of where its joint points are.
  for (const auto& state : impl_->groups) {
    const PartGroup& group = state->group;
    for (const PartGroup::Segment& segment : group.segments()) {
      const PackedModel& packed = *impl_->models[static_cast<std::size_t>(segment.model)];
      const Eigen::Index count = packed.arms.rows();
      const double* const d = group.displacements(segment.model).data() + segment.column * 3 * count;
      for (Eigen::Index i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const Vec3 local = packed.arms.row(i).transpose() + Vec3(d[i], d[count + i], d[2 * count + i]);
        quality.gap = std::max(quality.gap, (segment.mean + segment.rotation * local -
                                             group.point(state->x, segment.at[k], segment.stride[k]))
                                                .norm());
      }
    }
  }
  quality.kink = largest_kink(impl_->points, impl_->layout.faces, rim) -
                 largest_kink(impl_->layout.rest, impl_->layout.faces, rim);
  return quality;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
