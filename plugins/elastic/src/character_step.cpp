// The stages of a character's step.
#include <algorithm>

#include "character_state.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Of the forces, for the joints' response to them. Compliances of many points of a soft chain differ by
// little: coarser ones would not be positive definite together, and the solver of contacts would find no end.
constexpr double kResponse = 1e-8;
// Of the distance of joints: what pushes them farther is no small change any more.
constexpr double kLinear = 0.25;

}  // namespace

// Pushes begin anew; groups that had some last are slow, unless mass makes them so.
void Character::let_go_of_skin() {
  assembly_.clear_pushes();
  for (const auto& g : assembly_.impl_->groups) {
    g->dragged = false;
    g->solver.set_drag(0.0);
  }
}

void Character::push_skin(int point, const Vec3& force) {
  const State::SkinPoint& at = state_->skin[static_cast<std::size_t>(point)];
  PartGroup& group = assembly_.impl_->groups[static_cast<std::size_t>(at.group)]->group;
  if (at.segment < 0) {
    for (Eigen::Index a = 0; a < 3; ++a) group.loads[at.at + a * at.stride] += force[a];
  } else {
    group.pushes.push_back({at.segment, at.free, force});
  }
  GroupState& g = *assembly_.impl_->groups[static_cast<std::size_t>(at.group)];
  g.changed = g.skin_changed = true;
  if (!state_->moves_by_itself) {
    g.dragged = true;
    g.solver.set_drag(g.solver.steady());
  }
}

// Mass takes points on with their velocity, damping keeps them where they are.
void Character::begin_inertia(double dt) {
  State& state = *state_;
  for (std::size_t g = 0; g < assembly_.impl_->groups.size(); ++g) {
    GroupState& group = *assembly_.impl_->groups[g];
    bool same = true;
    for (std::size_t i = 0; i < state.masses[g].size(); ++i) {
      const double c = state.masses[g][i] / (dt * dt) + state.dampers[g][i] / dt;
      double& kept = group.inertia[static_cast<Eigen::Index>(i)];
      same = same && std::abs(kept - c) <= 1e-6 * c;
      if (!same) kept = c;
    }
    if (!same && group.factored) ++refactorizations_;
    group.factored = group.factored && same;
    group.toward = group.x;
    group.changed = true;
  }
  for (std::size_t p = 0; p < positions_.size(); ++p) {
    const State::SkinPoint& point = state.skin[p];
    if (point.segment >= 0) continue;
    const auto g = static_cast<std::size_t>(point.group);
    GroupState& group = *assembly_.impl_->groups[g];
    const double c = group.inertia[static_cast<Eigen::Index>(point.index)];
    if (c == 0.0) continue;
    const double mass = state.masses[g][point.index];
    // With all of its mass a joint falls as a whole; the mass of bones alone has no weight of its own.
    const Vec3 velocity =
        settings_.inertia && settings_.weight ? velocities_[p] : Vec3(velocities_[p] - dt * state.gravity);
    const Vec3 along = mass / (dt * c) * velocity;
    for (Eigen::Index a = 0; a < 3; ++a) {
      group.toward[point.at + a * point.stride] += along[a];
      // What flies freely is in balance there.
      if (settings_.inertia) group.x[point.at + a * point.stride] += along[a];
    }
  }
}

void Character::predict(double dt) {
  State& state = *state_;
  state.dt = dt;
  state.responded = false;
  for (const int point : state.slotted) state.slot_of[static_cast<std::size_t>(point)] = -1;
  state.slotted.clear();
  state.gravity = (velocities_.front() - state.first_velocity) / dt;
  if (state.gravity.norm() < 1e-9) state.gravity.setZero();  // rounding
  assembly_.set_gravity(settings_.weight && !settings_.inertia ? state.gravity : Vec3(Vec3::Zero()));
  for (const State::Attachment& a : state.attachments) {
    put_end(a.end, a.exoskeleton->end_positions_[static_cast<std::size_t>(a.vertex)] +
                       a.exoskeleton->frame_ * a.offset);
  }
  if (state.moves_by_itself) begin_inertia(dt);
  let_go_of_skin();
  // On an exoskeleton, with nothing on the skin, the shape is found once, after the exoskeleton: until then
  // the skin goes on as it did.
  state.postponed =
      !state.attachments.empty() && state.forces.empty() && !state.any_queued && state.solved_once;
  if (state.postponed) {
    const Vec3 change = dt * state.gravity;
    for (std::size_t p = 0; p < positions_.size(); ++p) {
      end_positions_[p] = positions_[p] + dt * (velocities_[p] - change);
    }
    return;
  }
  state.solved_once = true;
  if (state.any_queued) {
    for (std::size_t p = 0; p < positions_.size(); ++p) {
      if (state.queued[p].isZero(0)) continue;
      push_skin(static_cast<int>(p), state.queued[p] / dt);
      state.queued[p].setZero();
    }
    state.any_queued = false;
  }
  // Contact and handles held the skin with these forces in the last step. Balance is sought with them, and
  // then they are taken off again to first order: the solver of contacts finds the whole of them anew, and
  // when it finds the same ones, the shape is in balance however coarse that first order was.
  for (const State::SkinForce& f : state.forces) push_skin(f.point, f.force);
  assembly_.solve();
  std::copy(assembly_.points().begin(), assembly_.points().end(), end_positions_.begin());
  if (!state.forces.empty()) take_off_forces();
}

// Takes from end_positions_ what the forces of the last step do to first order.
void Character::take_off_forces() {
  State& state = *state_;
  for (State::Response& r : state.responses) {
    r.load.setZero();
    r.used = false;
  }
  for (const State::SkinForce& f : state.forces) {
    State::Response& r =
        state.responses[static_cast<std::size_t>(state.skin[static_cast<std::size_t>(f.point)].group)];
    r.used = true;
    state.add_joint_load(*assembly_.impl_, f.point, -f.force, r.load);
  }
  for (std::size_t g = 0; g < state.responses.size(); ++g) {
    State::Response& r = state.responses[g];
    if (!r.used) continue;
    assembly_.impl_->groups[g]->solver.respond(r.load, r.joints, kResponse);
    state.shift_skin(*assembly_.impl_, g, end_positions_);
  }
  for (const State::SkinForce& f : state.forces) dent(f.point, -f.force);
}

// m/N. A point that its holder keeps within a floor cannot be pushed out: it is taken to give way as the skin
// round it would, so that the force on the holder stays one that fits the depth.
double Character::held_give(int point) const {
  const State::SkinPoint& at = state_->skin[static_cast<std::size_t>(point)];
  if (at.segment >= 0) return 0.0;
  const GroupState& g = *assembly_.impl_->groups[static_cast<std::size_t>(at.group)];
  return g.held[at.index] != 0 ? g.group.spacing() / g.group.stiffness_scale() : 0.0;
}

// The dent that a force leaves in its own segment while the joints stay.
void Character::dent(int point, const Vec3& force) {
  const State::SkinPoint& at = state_->skin[static_cast<std::size_t>(point)];
  if (at.segment < 0) {
    end_positions_[static_cast<std::size_t>(point)] += held_give(point) * force;
    return;
  }
  const Assembly::Impl& impl = *assembly_.impl_;
  const PartGroup& group = impl.groups[static_cast<std::size_t>(at.group)]->group;
  const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(at.segment)];
  const SegmentModel& model = *group.models()[static_cast<std::size_t>(segment.model)]->model;
  const std::vector<int>& names = impl.layout.point_of[static_cast<std::size_t>(segment.placed)];
  for (int i = 0; i < model.free_points(); ++i) {
    const auto v = static_cast<std::size_t>(model.free_vertices[static_cast<std::size_t>(i)]);
    end_positions_[static_cast<std::size_t>(names[v])] +=
        segment.rotation * (local_compliance(model, i, at.free) * (segment.rotation.transpose() * force));
  }
}

// Response of the joints to unit forces on a point of the skin.
int Character::columns_of(int point) {
  State& state = *state_;
  int& slot = state.slot_of[static_cast<std::size_t>(point)];
  if (slot >= 0) return slot;
  slot = 3 * static_cast<int>(state.slotted.size());
  state.slotted.push_back(point);
  // Many at a time: how many points are touched wavers.
  constexpr std::size_t kSlots = 64;
  if (state.rows.size() < state.slotted.size()) {
    state.rows.resize(state.slotted.size() + kSlots, Eigen::Matrix3Xd::Zero(3, state.largest_row));
    state.columns.resize(3 * state.rows.size(), Eigen::VectorXd::Zero(state.largest_group));
    state.slotted.reserve(state.rows.size() + 1);
  }
  const auto g = static_cast<std::size_t>(state.skin[static_cast<std::size_t>(point)].group);
  state.find_row(*assembly_.impl_, point, state.rows[state.slotted.size() - 1]);
  for (int a = 0; a < 3; ++a) {
    auto column =
        state.columns[static_cast<std::size_t>(slot + a)].head(assembly_.impl_->groups[g]->group.size());
    state.responses[g].load.setZero();
    state_->add_joint_load(*assembly_.impl_, point, Vec3::Unit(a), state.responses[g].load);
    assembly_.impl_->groups[g]->solver.respond(state.responses[g].load, column, kResponse);
  }
  return slot;
}

// dv_i / dJ_j = C_ij / h^2: an impulse J is a force J/h, and what it moves by u moves at u/h.
void Character::compliance(std::span<const int> touched, double* blocks) {
  State& state = *state_;
  const Assembly::Impl& impl = *assembly_.impl_;
  const auto count = static_cast<Eigen::Index>(touched.size());
  Eigen::Map<Eigen::MatrixXd> c(blocks, 3 * count, 3 * count);
  c.setZero();
  for (Eigen::Index j = 0; j < count; ++j) {
    const int point = touched[static_cast<std::size_t>(j)];
    const int slot = columns_of(point);
    const State::SkinPoint& at = state.skin[static_cast<std::size_t>(point)];
    const PartGroup& group = impl.groups[static_cast<std::size_t>(at.group)]->group;
    int gathered = -1;  // points of a segment mostly stand together
    for (Eigen::Index i = 0; i < count; ++i) {
      const int other = touched[static_cast<std::size_t>(i)];
      const State::SkinPoint& to = state.skin[static_cast<std::size_t>(other)];
      if (to.group != at.group) continue;
      if (to.segment < 0) {
        for (int a = 0; a < 3; ++a) {
          c.block<3, 1>(3 * i, 3 * j + a) =
              group.point(state.columns[static_cast<std::size_t>(slot + a)], to.at, to.stride);
        }
        continue;
      }
      const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(to.segment)];
      if (to.segment != gathered) {
        gathered = to.segment;
        state.gather(segment, slot);
      }
      c.block<3, 3>(3 * i, 3 * j).noalias() =
          state.rows[static_cast<std::size_t>(columns_of(other) / 3)].leftCols(
              3 * static_cast<Eigen::Index>(segment.at.size())) *
          state.gathered.topRows(3 * static_cast<Eigen::Index>(segment.at.size()));
      if (to.segment != at.segment) continue;
      const SegmentModel& model = *impl.models[static_cast<std::size_t>(segment.model)]->model;
      c.block<3, 3>(3 * i, 3 * j) +=
          segment.rotation * local_compliance(model, to.free, at.free) * segment.rotation.transpose();
    }
  }
  for (Eigen::Index j = 0; j < 3 * count; ++j) {
    for (Eigen::Index i = 0; i < j; ++i) c(i, j) = c(j, i) = 0.5 * (c(i, j) + c(j, i));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    c.diagonal().segment<3>(3 * i).array() += held_give(touched[static_cast<std::size_t>(i)]);
  }
  c *= 1.0 / (state.dt * state.dt);
}

void Character::respond(std::span<const int> touched, std::span<const Vec3> impulses) {
  State& state = *state_;
  state.responded = true;
  end_positions_ = free_positions_;
  state.forces_now.resize(touched.size());
  for (State::Response& r : state.responses) {
    r.joints.setZero();
    r.used = false;
  }
  for (std::size_t j = 0; j < touched.size(); ++j) {
    state.forces_now[j] = {touched[j], impulses[j] / state.dt};
    const auto g = static_cast<std::size_t>(state.skin[static_cast<std::size_t>(touched[j])].group);
    state.responses[g].used = true;
    const int slot = columns_of(touched[j]);
    for (int a = 0; a < 3; ++a) {
      state.responses[g].joints +=
          state.forces_now[j].force[a] *
          state.columns[static_cast<std::size_t>(slot + a)].head(state.responses[g].joints.size());
    }
  }
  for (std::size_t g = 0; g < state.responses.size(); ++g) {
    if (state.responses[g].used) state.shift_skin(*assembly_.impl_, g, end_positions_);
  }
  for (std::size_t j = 0; j < touched.size(); ++j) {
    dent(touched[j], state.forces_now[j].force);
  }
}

void Character::commit(double dt) {
  State& state = *state_;
  const bool touched = !state.forces.empty() || state.responded;
  state.forces.swap(state.forces_now);
  if (!state.responded) state.forces.clear();
  if (touched) {
    if (farthest_joint(end_positions_) > kLinear) {
      solve_under_forces();
    } else {
      take_joints(end_positions_);
    }
  }
  follow_exoskeletons();
  Deformable::commit(dt);
  state.first_velocity = velocities_.front();
  load_exoskeletons();
}

// How far the farthest joint point is from where it was balanced, over the distance of joints.
double Character::farthest_joint(const std::vector<Vec3>& from) const {
  double farthest = 0;
  for (std::size_t p = 0; p < from.size(); ++p) {
    const State::SkinPoint& point = state_->skin[p];
    if (point.segment >= 0) continue;
    const GroupState& g = *assembly_.impl_->groups[static_cast<std::size_t>(point.group)];
    farthest =
        std::max(farthest, (from[p] - g.group.point(g.x, point.at, point.stride)).norm() / g.group.spacing());
  }
  return farthest;
}

// Balance with the forces that contact and handles were found to bear: what a linear response cannot reach.
// They have their say again in the next step.
void Character::solve_under_forces() {
  let_go_of_skin();
  for (const State::SkinForce& f : state_->forces) push_skin(f.point, f.force);
  assembly_.solve();
  std::copy(assembly_.points().begin(), assembly_.points().end(), end_positions_.begin());
}

void Character::take_joints(const std::vector<Vec3>& from) {
  for (std::size_t p = 0; p < from.size(); ++p) {
    const State::SkinPoint& point = state_->skin[p];
    if (point.segment >= 0) continue;
    GroupState& g = *assembly_.impl_->groups[static_cast<std::size_t>(point.group)];
    for (Eigen::Index a = 0; a < 3; ++a) g.x[point.at + a * point.stride] = from[p][a];
    g.changed = g.skin_changed = true;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
