#include "softpoint/elastic/assembly.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

#include "assembly_impl.h"
#include "instruction_set.h"
#include "rotation_fit.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void check(const AssemblySettings& settings) {
  check_range("AssemblySettings.method", static_cast<int>(settings.method), 0, 1);
  check_range("AssemblySettings.tolerance", settings.tolerance, 1e-14, 1.0);
  check_range("AssemblySettings.max_iterations", settings.max_iterations, 0, 100000);
  check_range("AssemblySettings.kappa", settings.kappa, 0.0, 1e300);
  check_range("AssemblySettings.predictor", static_cast<int>(settings.predictor), 0, 2);
  check_range("AssemblySettings.ik_sweeps", settings.ik_sweeps, 0, 1000);
  check_range("AssemblySettings.max_instruction_set", static_cast<int>(settings.max_instruction_set), 0,
              static_cast<int>(InstructionSet::kAvx512));
}

GroupState::GroupState(const AssemblyDesign& design, const PlacedDesign& placed, int index,
                       const std::vector<std::shared_ptr<const PackedModel>>& models, const Kernels& kernels,
                       bool single)
    : group(design, placed, index, models),
      solver(group, kernels, single),
      x(group.rest()),
      target(group.rest()),
      skinned(group.rest()),
      toward(group.rest()),
      before(group.rest()),
      carried(group.rest()),
      settled(Eigen::VectorXd::Zero(group.size())),
      inertia(Eigen::VectorXd::Zero(group.points())),
      held(static_cast<std::size_t>(group.points()), 0),
      ends(group.joints().size(), Hold::kNothing) {}

namespace {

AssemblyDesign moved(AssemblyDesign design, const Vec3& origin, const Mat3& rotation) {
  for (PartDesign& part : design.parts) {
    part.root = rotation * part.root + origin;
    part.rotation = rotation * part.rotation;
  }
  return design;
}

AssemblyDesign checked(const AssemblyDesign& design) {
  check(design);
  return design;
}

}  // namespace

Assembly::Impl::Impl(const AssemblyDesign& given, const AssemblySettings& wanted, const Vec3& origin,
                     const Mat3& rotation)
    : design(moved(checked(given), origin, rotation)), settings(wanted) {
  check(settings);
  check(design);
  kernels = &kernels_for(choose_instruction_set(settings.max_instruction_set));
  placed = place(design);
  layout = lay_out_skin(placed);
  points = layout.rest;
  for (const PlacedSegment& segment : placed.segments) {
    const auto known = [&](const auto& m) { return m->model == segment.model; };
    if (std::none_of(models.begin(), models.end(), known)) {
      models.push_back(pack_model(*segment.model, *kernels, settings.single_precision));
    }
  }
  joint_places.resize(placed.joints.size());
  segment_places.resize(placed.segments.size());
  std::size_t longest = 0;
  for (int g = 0; g < placed.groups; ++g) {
    groups.push_back(
        std::make_unique<GroupState>(design, placed, g, models, *kernels, settings.single_precision));
    groups.back()->group.turn_surfaces(settings.surface_turns);
    const PartGroup& group = groups.back()->group;
    for (std::size_t j = 0; j < group.joints().size(); ++j) {
      joint_places[static_cast<std::size_t>(group.joint_ids()[j])] = {g, static_cast<int>(j)};
    }
    for (std::size_t s = 0; s < group.segments().size(); ++s) {
      segment_places[static_cast<std::size_t>(group.segments()[s].placed)] = {g, static_cast<int>(s)};
    }
    for (const PartGroup::Bone& bone : group.bones()) longest = std::max(longest, bone.at.size());
  }
  bone_now.resize(longest);
  bone_next.resize(longest);
  for (const PlacedJoint& joint : placed.joints) {
    first_joint_skin.push_back(static_cast<int>(joint_skin.size()));
    const auto segment = static_cast<std::size_t>(joint.interfaces.front()[0]);
    const auto interface = static_cast<std::size_t>(joint.interfaces.front()[1]);
    const std::vector<int>& vertices = placed.segments[segment].model->interfaces[interface];
    std::vector<int> order(vertices.size());
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      order[static_cast<std::size_t>(joint.order.front()[k])] =
          layout.point_of[segment][static_cast<std::size_t>(vertices[k])];
    }
    joint_skin.insert(joint_skin.end(), order.begin(), order.end());
  }
  reserve_skin();
  for (const auto& state : groups) factor(*state);
  check_kappa(settings);
  report.groups = placed.groups;
  report.segments = static_cast<int>(placed.segments.size());
}

// Holding more only lowers the greatest stiffness, and mass on top of it is let be: the last one measured is
// the limit.
void Assembly::Impl::check_kappa(const AssemblySettings& wanted) const {
  if (wanted.method != JointMethod::kRichardson || wanted.kappa == 0.0) return;
  for (const auto& state : groups) {
    check_range("AssemblySettings.kappa", wanted.kappa, 0.0, 2.0 / state->solver.greatest_stiffness());
  }
}

void Assembly::Impl::check_end(const PartEnd& end) const {
  check_index("end.part", end.part, static_cast<long long>(design.parts.size()));
}

Assembly::Impl::Place Assembly::Impl::place_of(const PartEnd& end) const {
  check_end(end);
  const std::vector<int>& row = placed.part_joints[static_cast<std::size_t>(end.part)];
  const auto& at = joint_places[static_cast<std::size_t>(end.tip ? row.back() : row.front())];
  return {groups[static_cast<std::size_t>(at[0])].get(), static_cast<std::size_t>(at[1])};
}

Assembly::Impl::Place Assembly::Impl::held_place(const PartEnd& end) const {
  const Place place = place_of(end);
  if (place.state->ends[place.joint] == Hold::kNothing) {
    throw Error("end of part " + std::to_string(end.part) + (end.tip ? " (tip)" : " (root)") +
                " is not held; permitted are ends that hold() was called for");
  }
  return place;
}

Assembly::Assembly(const AssemblyDesign& design, const AssemblySettings& settings, const Vec3& origin,
                   const Mat3& rotation) {
  check_range("Assembly: origin", origin, -kMaxPosition, kMaxPosition);
  check_range("Assembly: rotation, distance from a rotation matrix",
              (rotation.transpose() * rotation - Mat3::Identity()).norm(), 0.0, 1e-6);
  impl_ = std::make_unique<Impl>(design, settings, origin, rotation);
}
Assembly::~Assembly() = default;
Assembly::Assembly(Assembly&&) noexcept = default;
Assembly& Assembly::operator=(Assembly&&) noexcept = default;

const AssemblyDesign& Assembly::design() const { return impl_->design; }
const AssemblySettings& Assembly::settings() const { return impl_->settings; }

void Assembly::set_settings(const AssemblySettings& settings) {
  check(settings);
  AssemblySettings next = settings;
  next.single_precision = impl_->settings.single_precision;
  next.max_instruction_set = impl_->settings.max_instruction_set;
  impl_->check_kappa(next);
  for (const auto& state : impl_->groups) {
    state->group.turn_surfaces(next.surface_turns);
    state->changed = true;
  }
  impl_->settings = next;
}

void Assembly::hold(const PartEnd& end, Hold what) {
  const Impl::Place place = impl_->place_of(end);
  GroupState& state = *place.state;
  const PartGroup::Joint& joint = state.group.joints()[place.joint];
  if (joint.segments[1] >= 0) {
    throw Error("hold: end of part " + std::to_string(end.part) +
                " is joined to a patch; permitted are free ends");
  }
  check_range("hold: what", static_cast<int>(what), 0, 2);
  if (state.ends[place.joint] == what) return;
  state.ends[place.joint] = what;
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    state.held[static_cast<std::size_t>(joint.first + i)] =
        what == Hold::kSurface || (what == Hold::kPoint && i == 0) ? 1 : 0;
  }
  const Eigen::Index first = 3 * joint.first, size = 3 * joint.count;
  state.target.segment(first, size) = state.x.segment(first, size);
  state.factored = false;
  state.changed = true;
  state.settled.setZero();
}

Hold Assembly::held(const PartEnd& end) const {
  const Impl::Place place = impl_->place_of(end);
  return place.state->ends[place.joint];
}

void Assembly::move(const PartEnd& end, const Vec3& position) {
  const Impl::Place place = impl_->held_place(end);
  check_range("move: position", position, -kMaxPosition, kMaxPosition);
  const PartGroup::Joint& joint = place.state->group.joints()[place.joint];
  // As the surface is turned now.
  Eigen::VectorXd& target = place.state->target;
  const Vec3 shift = position - place.state->group.point(target, 3 * joint.first, joint.count);
  if (shift.isZero(0)) return;
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    for (Eigen::Index a = 0; a < 3; ++a) target[3 * joint.first + a * joint.count + i] += shift[a];
  }
  for (Eigen::Index a = 0; a < 3; ++a) target[3 * joint.first + a * joint.count] = position[a];
  place.state->changed = true;
}

void Assembly::move(const PartEnd& end, const Vec3& position, const Mat3& turn) {
  const Impl::Place place = impl_->held_place(end);
  check_range("move: position", position, -kMaxPosition, kMaxPosition);
  check_range("move: turn, distance from a rotation matrix",
              (turn.transpose() * turn - Mat3::Identity()).norm() + std::abs(turn.determinant() - 1.0), 0.0,
              1e-6);
  GroupState& state = *place.state;
  const PartGroup::Joint& joint = state.group.joints()[place.joint];
  const Eigen::VectorXd& rest = state.group.rest();
  const Vec3 pivot = state.group.point(rest, 3 * joint.first, joint.count);
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    const Vec3 to = position + turn * (state.group.point(rest, 3 * joint.first + i, joint.count) - pivot);
    for (Eigen::Index a = 0; a < 3; ++a) {
      double& now = state.target[3 * joint.first + a * joint.count + i];
      state.changed = state.changed || now != to[a];
      now = to[a];
    }
  }
}

void Assembly::set_gravity(const Vec3& gravity) {
  check_range("set_gravity: gravity", gravity, -kMaxAcceleration, kMaxAcceleration);
  if (impl_->gravity == gravity) return;
  impl_->gravity = gravity;
  for (const auto& state : impl_->groups) {
    state->group.gravity = gravity;
    state->changed = state->skin_changed = true;
  }
}

void Assembly::push(const SegmentVertex& vertex, const Vec3& force) {
  point_of(vertex);
  check_range("push: force", force, -1e15, 1e15);
  const int placed_index =
      impl_->placed.first_segment[static_cast<std::size_t>(vertex.part)] + vertex.segment;
  const auto& at = impl_->segment_places[static_cast<std::size_t>(placed_index)];
  GroupState& state = *impl_->groups[static_cast<std::size_t>(at[0])];
  const PartGroup::Segment& segment = state.group.segments()[static_cast<std::size_t>(at[1])];
  const SegmentModel& model = *impl_->models[static_cast<std::size_t>(segment.model)]->model;
  const auto find = [&](const std::vector<int>& in) {
    return static_cast<std::size_t>(std::find(in.begin(), in.end(), vertex.vertex) - in.begin());
  };
  const std::size_t joint = find(model.joint_vertices);
  if (joint < model.joint_vertices.size()) {
    for (Eigen::Index a = 0; a < 3; ++a) {
      state.group.loads[segment.at[joint] + a * segment.stride[joint]] = force[a];
    }
  } else {
    const int free = static_cast<int>(find(model.free_vertices));
    auto& pushes = state.group.pushes;
    const auto same = std::find_if(pushes.begin(), pushes.end(), [&](const SkinPush& p) {
      return p.segment == at[1] && p.free_point == free;
    });
    if (same == pushes.end()) {
      pushes.push_back({at[1], free, force});
    } else {
      same->force = force;
    }
  }
  state.changed = state.skin_changed = true;
}

void Assembly::clear_pushes() {
  for (const auto& state : impl_->groups) {
    if (state->group.pushes.empty() && state->group.loads.isZero(0)) continue;
    state->group.pushes.clear();
    state->group.loads.setZero();
    state->changed = state->skin_changed = true;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
