// The stages of a character's step.
#include <algorithm>

#include "character_state.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

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
  state.let_go();
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
  for (const SkinForce& f : state.forces) push_skin(f.point, f.force);
  assembly_.solve();
  std::copy(assembly_.points().begin(), assembly_.points().end(), end_positions_.begin());
  if (!state.forces.empty()) take_off_forces();
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
  for (const SkinForce& f : state_->forces) push_skin(f.point, f.force);
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
