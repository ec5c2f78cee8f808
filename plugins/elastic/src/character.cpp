#include "softpoint/elastic/character.h"

#include <Eigen/Geometry>

#include <algorithm>

#include "character_state.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void check(const CharacterSettings& settings) { check(settings.joints); }

namespace {

// Joints carry the mass; what is left to the free vertices only has to be positive.
constexpr double kMasslessPart = 1e-9;

}  // namespace

Character::Character(const AssemblyDesign& design, const CharacterSettings& settings, const Vec3& origin,
                     const Mat3& rotation)
    : Character(Assembly(design, (check(settings), settings.joints), origin, rotation), settings) {}

Character::Character(Assembly assembly, const CharacterSettings& settings)
    : Deformable({assembly.points().begin(), assembly.points().end()},
                 {assembly.faces().begin(), assembly.faces().end()},
                 assembly.impl_->point_masses(kMasslessPart)),
      assembly_(std::move(assembly)),
      settings_(settings),
      state_(std::make_unique<State>()) {
  Assembly::Impl& impl = *assembly_.impl_;
  State& state = *state_;
  state.skin.resize(positions_.size());
  for (std::size_t s = 0; s < impl.placed.segments.size(); ++s) {
    const auto& place = impl.segment_places[s];
    const PartGroup& group = impl.groups[static_cast<std::size_t>(place[0])]->group;
    const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(place[1])];
    const SegmentModel& model = *impl.placed.segments[s].model;
    for (std::size_t i = 0; i < model.free_vertices.size(); ++i) {
      const auto v = static_cast<std::size_t>(model.free_vertices[i]);
      state.skin[static_cast<std::size_t>(impl.layout.point_of[s][v])] = {
          place[0], place[1], static_cast<int>(i), 0, 0, 0};
    }
    for (std::size_t i = 0; i < model.joint_vertices.size(); ++i) {
      const auto v = static_cast<std::size_t>(model.joint_vertices[i]);
      state.skin[static_cast<std::size_t>(impl.layout.point_of[s][v])] = {
          place[0], -1, 0, segment.at[i], segment.stride[i], group.index_of(segment.at[i])};
    }
  }
  for (const auto& g : impl.groups) {
    const auto points = static_cast<std::size_t>(g->group.points());
    state.masses.emplace_back(points, 0.0);
    state.dampers.emplace_back(points, 0.0);
    state.touched.emplace_back().joints.setZero(g->group.size());
    if (settings_.inertia) {
      for (const PartGroup::Segment& segment : g->group.segments()) {
        const SegmentModel& model = *impl.models[static_cast<std::size_t>(segment.model)]->model;
        for (const Eigen::Index at : segment.at) {
          state.masses.back()[g->group.index_of(at)] += model.mass / model.joint_points();
        }
      }
    }
    for (const PartGroup::Bone& bone : g->group.bones()) {
      for (const Eigen::Index at : bone.at) {
        state.masses.back()[g->group.index_of(at)] += bone.settings.mass;
        state.dampers.back()[g->group.index_of(at)] += bone.settings.damping;
        state.moves_by_itself =
            state.moves_by_itself || bone.settings.mass > 0.0 || bone.settings.damping > 0.0;
      }
    }
  }
  state.moves_by_itself = state.moves_by_itself || settings_.inertia;
  state.queued.assign(positions_.size(), Vec3::Zero());
  state.slot_of.assign(positions_.size(), -1);
  for (const auto& m : impl.models) {
    state.largest_row = std::max(state.largest_row, static_cast<Eigen::Index>(3 * m->model->joint_points()));
  }
  state.end_stiffness.assign(impl.groups.size(), 0.0);
}

Character::~Character() {
  for (const State::Attachment& a : state_->attachments) a.exoskeleton->clear_point_loads();
}

void Character::set_joint_settings(const AssemblySettings& settings) {
  assembly_.set_settings(settings);
  settings_.joints = assembly_.settings();
  wake();
}

void Character::hold(const PartEnd& end, Hold what) {
  assembly_.hold(end, what);
  std::fill(state_->end_stiffness.begin(), state_->end_stiffness.end(), 0.0);
  wake();
}

void Character::move(const PartEnd& end, const Vec3& position) {
  assembly_.move(end, position);
  wake();
}

void Character::move(const PartEnd& end, const Vec3& position, const Mat3& turn) {
  assembly_.move(end, position, turn);
  wake();
}

void Character::attach(const PartEnd& end, ElasticBody& exoskeleton, int vertex) {
  check_index("attach: vertex", vertex, static_cast<long long>(exoskeleton.points().size()));
  if (settings_.inertia) {
    throw Error("attach: the character has inertia; permitted are CharacterSettings.inertia = false");
  }
  assembly_.hold(end, Hold::kPoint);
  const Assembly::Impl::Place place = assembly_.impl_->place_of(end);
  const PartGroup& group = place.state->group;
  const PartGroup::Joint& joint = group.joints()[place.joint];
  const Vec3 at = group.point(place.state->x, 3 * joint.first, joint.count);
  std::erase_if(state_->attachments,
                [&](const State::Attachment& a) { return a.end.part == end.part && a.end.tip == end.tip; });
  state_->attachments.push_back(
      {end, &exoskeleton, vertex,
       exoskeleton.frame().transpose() * (at - exoskeleton.points()[static_cast<std::size_t>(vertex)])});
  setIgnoreCollisionCheck(&exoskeleton, true);
  exoskeleton.setIgnoreCollisionCheck(this, true);
  std::fill(state_->end_stiffness.begin(), state_->end_stiffness.end(), 0.0);
  wake();
}

void Character::release(const PartEnd& end) {
  assembly_.hold(end, Hold::kNothing);
  std::erase_if(state_->attachments, [&](const State::Attachment& a) {
    const bool here = a.end.part == end.part && a.end.tip == end.tip;
    if (here) a.exoskeleton->clear_point_loads();
    return here;
  });
  std::fill(state_->end_stiffness.begin(), state_->end_stiffness.end(), 0.0);
  wake();
}

double Character::elastic_energy() const { return assembly_.elastic_energy(); }

void Character::queue_impulse(int point, const Vec3& impulse) {
  state_->queued[static_cast<std::size_t>(point)] += impulse;
  state_->any_queued = true;
}

void Character::archive_state(StateArchive& archive) {
  Assembly::Impl& impl = *assembly_.impl_;
  archive.constant("groups of parts", static_cast<std::uint64_t>(impl.groups.size()));
  for (const auto& g : impl.groups) {
    for (PartGroup::Segment& segment : g->group.segments()) archive.rotation("frame", segment.rotation);
    for (Eigen::Index i = 0; i < g->target.size(); ++i) archive.number("target", g->target[i]);
    for (double& moved : g->settled) archive.number("moved by itself", moved);
    for (Hold& hold : g->ends) archive.constant("hold", static_cast<std::uint64_t>(hold));
  }
  archive.vector("velocity", state_->first_velocity);
  archive.vectors("impulses", state_->queued);
  archive.flag("impulses queued", state_->any_queued);
  archive.list("contact forces", state_->forces, static_cast<long long>(positions_.size()),
               [&](SkinForce& f) {
                 archive.integer("point", f.point, 0, static_cast<int>(positions_.size()) - 1);
                 archive.vector("force", f.force);
               });
  if (archive.loading()) restored();
}

// Joints as the skin has them.
void Character::restored() {
  Assembly::Impl& impl = *assembly_.impl_;
  for (std::size_t p = 0; p < positions_.size(); ++p) {
    const State::SkinPoint& point = state_->skin[p];
    if (point.segment >= 0) continue;
    GroupState& g = *impl.groups[static_cast<std::size_t>(point.group)];
    for (Eigen::Index a = 0; a < 3; ++a) g.x[point.at + a * point.stride] = positions_[p][a];
  }
  for (const auto& g : impl.groups) g->changed = g->skin_changed = true;
  state_->first_velocity = velocities_.front();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
