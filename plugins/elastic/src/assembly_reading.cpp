// What can be read from an assembly.
#include <Eigen/Geometry>

#include <algorithm>

#include "assembly_impl.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

const AssemblyReport& Assembly::report() const { return impl_->report; }

Vec3 Assembly::force(const PartEnd& end) const {
  const Impl::Place place = impl_->place_of(end);
  if (place.state->ends[place.joint] == Hold::kNothing) return Vec3::Zero();
  Impl::find_forces(*place.state);
  const PartGroup::Joint& joint = place.state->group.joints()[place.joint];
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    if (place.state->held[static_cast<std::size_t>(joint.first + i)] == 0) continue;
    sum += place.state->group.point(place.state->solver.gradient(), 3 * joint.first + i, joint.count);
  }
  return sum;
}

Vec3 Assembly::moment(const PartEnd& end) const {
  const Impl::Place place = impl_->place_of(end);
  Impl::find_forces(*place.state);
  const PartGroup& group = place.state->group;
  const PartGroup::Joint& joint = group.joints()[place.joint];
  const Vec3 about = group.point(place.state->x, 3 * joint.first, joint.count);
  Vec3 sum = Vec3::Zero();
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    if (place.state->held[static_cast<std::size_t>(joint.first + i)] == 0) continue;
    const Eigen::Index at = 3 * joint.first + i;
    sum += (group.point(place.state->x, at, joint.count) - about)
               .cross(group.point(place.state->solver.gradient(), at, joint.count));
  }
  return sum;
}

std::vector<Vec3> Assembly::bone(int part) const {
  check_index("bone: part", part, static_cast<long long>(impl_->design.parts.size()));
  std::vector<Vec3> joints;
  for (const auto& state : impl_->groups) {
    for (const PartGroup::Bone& bone : state->group.bones()) {
      if (bone.part != part) continue;
      for (std::size_t i = 0; i < bone.at.size(); ++i) {
        joints.push_back(state->group.point(state->x, bone.at[i], bone.stride[i]));
      }
    }
  }
  return joints;
}

std::vector<double> Assembly::Impl::point_masses(double free_part) const {
  std::vector<double> masses(points.size(), 0.0);
  for (std::size_t s = 0; s < placed.segments.size(); ++s) {
    const SegmentModel& model = *placed.segments[s].model;
    for (const int v : model.joint_vertices) {
      masses[static_cast<std::size_t>(layout.point_of[s][static_cast<std::size_t>(v)])] +=
          model.mass / model.joint_points();
    }
    for (const int v : model.free_vertices) {
      masses[static_cast<std::size_t>(layout.point_of[s][static_cast<std::size_t>(v)])] =
          std::max(free_part * model.mass / model.joint_points(), kMinPointMass);
    }
  }
  return masses;
}

double Assembly::elastic_energy() const {
  double sum = 0;
  for (const auto& state : impl_->groups) {
    Impl::find_forces(*state);
    sum += state->group.elastic_energy();
  }
  return sum;
}

double Assembly::energy() const {
  double sum = 0;
  for (const auto& state : impl_->groups) {
    Impl::find_forces(*state);
    sum += state->energy;
  }
  return sum;
}

std::span<const Vec3> Assembly::points() const { return impl_->points; }
std::span<const Triangle> Assembly::faces() const { return impl_->layout.faces; }
int Assembly::visible_points() const { return impl_->layout.visible; }

int Assembly::point_of(const SegmentVertex& vertex) const {
  const AssemblyDesign& design = impl_->design;
  check_index("vertex.part", vertex.part, static_cast<long long>(design.parts.size()));
  const PartDesign& part = design.parts[static_cast<std::size_t>(vertex.part)];
  check_index("vertex.segment", vertex.segment, static_cast<long long>(part.segments.size()));
  check_index("vertex.vertex", vertex.vertex,
              part.segments[static_cast<std::size_t>(vertex.segment)]->mesh.vertex_count());
  const int placed = impl_->placed.first_segment[static_cast<std::size_t>(vertex.part)] + vertex.segment;
  return impl_->layout.point_of[static_cast<std::size_t>(placed)][static_cast<std::size_t>(vertex.vertex)];
}

double Assembly::volume() const {
  double sum = 0;
  for (const Triangle& t : impl_->layout.faces) {
    const auto at = [&](std::size_t k) -> const Vec3& {
      return impl_->points[static_cast<std::size_t>(t[k])];
    };
    sum += at(0).dot(at(1).cross(at(2))) / 6.0;
  }
  return sum;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
