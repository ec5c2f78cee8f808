// What a group of parts is made of, laid out for its products.
#include <algorithm>

#include "part_group.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

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

Eigen::Map<const Eigen::MatrixXd> columns_of(const std::vector<double>& values, Eigen::Index rows,
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
  packed->stiffness = Product(kernels, columns_of(model.stiffness, 3 * joint, 3 * joint), single);
  packed->exact_stiffness =
      single ? Product(kernels, columns_of(model.stiffness, 3 * joint, 3 * joint), false) : packed->stiffness;
  packed->free_response = Product(kernels, columns_of(model.free_response, 3 * free, 3 * joint), single);
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
        stiffness_scale_, columns_of(model.stiffness, 3 * model.joint_points(), 3 * model.joint_points())
                                  .diagonal()
                                  .maxCoeff() *
                              spacing_);
  }
}

void PartGroup::turn_surfaces(bool on) {
  for (std::size_t m = 0; m < models_.size(); ++m) {
    Batch& batch = batches_[m];
    if (on != batch.turns.empty() || batch.segments.empty()) continue;
    if (!on) {
      batch.turns.clear();
      continue;
    }
    batch.turns.emplace_back(*models_[m]->model, models_[m]->arms,
                             static_cast<Eigen::Index>(batch.segments.size()));
    batch.strains.assign(batch.displacements.size(), 0.0);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
