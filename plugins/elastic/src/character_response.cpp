// How a character gives way to forces on its skin.
#include <algorithm>

#include "character_state.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

void Character::State::let_go() {
  for (Touched& group : touched) {
    for (const int point : group.points) slot_of[static_cast<std::size_t>(point)] = -1;
    group.points.clear();
  }
}

void Character::State::touch(Assembly::Impl& impl, std::span<const int> more) {
  // Many at a time: how many points are touched wavers.
  constexpr std::size_t kMore = 64;
  for (std::size_t g = 0; g < touched.size(); ++g) {
    Touched& group = touched[g];
    const auto known = static_cast<Eigen::Index>(group.points.size());
    for (const int point : more) {
      int& slot = slot_of[static_cast<std::size_t>(point)];
      if (skin[static_cast<std::size_t>(point)].group != static_cast<int>(g) || slot >= 0) continue;
      slot = static_cast<int>(group.points.size());
      group.points.push_back(point);
    }
    const auto count = static_cast<Eigen::Index>(group.points.size());
    if (count == known) continue;
    if (group.columns.rows() < 3 * count) {
      group.points.reserve(group.points.size() + kMore);
      const Eigen::Index room = 3 * (count + static_cast<Eigen::Index>(kMore));
      group.columns.conservativeResize(room, impl.groups[g]->group.size());
      group.rows.conservativeResize(room, largest_row);
      group.compliance.conservativeResize(room, room);
      group.force.conservativeResize(room);
    }
    group.columns.middleRows(3 * known, 3 * (count - known)).setZero();
    for (Eigen::Index s = known; s < count; ++s) {
      const int point = group.points[static_cast<std::size_t>(s)];
      for (Eigen::Index a = 0; a < 3; ++a) {
        add_joint_load(impl, point, Vec3::Unit(a), group.columns.row(3 * s + a).transpose());
      }
      find_row(impl, point, group);
    }
    impl.groups[g]->solver.respond(group.columns.data() + 3 * known, 3 * (count - known),
                                   group.columns.rows(), scratch);
    find_compliance(impl, group, known);
  }
}

// Of the points from `known` on with all: C = U H^-1 U^T with the rows U of points, joints' own ones being
// units, and the dents within a segment.
void Character::State::find_compliance(const Assembly::Impl& impl, Touched& of, Eigen::Index known) {
  const auto place = [&](Eigen::Index s) -> const SkinPoint& {
    return skin[static_cast<std::size_t>(of.points[static_cast<std::size_t>(s)])];
  };
  const auto count = static_cast<Eigen::Index>(of.points.size());
  const Eigen::Index first = 3 * known, more = 3 * (count - known);
  const PartGroup& group = impl.groups[static_cast<std::size_t>(place(0).group)]->group;
  gathered.resize(std::max(gathered.rows(), more), std::max(gathered.cols(), largest_row));
  Eigen::Index end = 0;
  for (Eigen::Index s = 0; s < count; s = end) {  // points of a segment mostly stand together
    end = s + 1;
    auto block = of.compliance.block(first, 3 * s, more, 3);
    if (place(s).segment < 0) {
      for (Eigen::Index a = 0; a < 3; ++a) {
        block.col(a) = of.columns.col(place(s).at + a * place(s).stride).segment(first, more);
      }
      continue;
    }
    while (end < count && place(end).segment == place(s).segment) ++end;
    const PartGroup::Segment& segment = group.segments()[static_cast<std::size_t>(place(s).segment)];
    const SegmentModel& model = *impl.models[static_cast<std::size_t>(segment.model)]->model;
    const Eigen::Index joints = model.joint_points();
    for (Eigen::Index b = 0; b < 3; ++b) {
      for (Eigen::Index i = 0; i < joints; ++i) {
        const auto k = static_cast<std::size_t>(i);
        gathered.col(b * joints + i).head(more) =
            of.columns.col(segment.at[k] + b * segment.stride[k]).segment(first, more);
      }
    }
    of.compliance.block(first, 3 * s, more, 3 * (end - s)).setZero();
    impl.kernels->add_product(more, 3 * (end - s), 3 * joints, 1.0, gathered.data(), 1, gathered.rows(),
                              of.rows.data() + 3 * s, 1, of.rows.rows(), &of.compliance(first, 3 * s),
                              of.compliance.rows(), scratch.data());
    for (Eigen::Index j = known; j < count; ++j) {
      if (place(j).segment != place(s).segment) continue;
      for (Eigen::Index i = s; i < end; ++i) {
        of.compliance.block<3, 3>(3 * j, 3 * i) += segment.rotation *
                                                   local_compliance(model, place(j).free, place(i).free) *
                                                   segment.rotation.transpose();
      }
    }
  }
  for (Eigen::Index j = first; j < first + more; ++j) {
    for (Eigen::Index i = first; i < j; ++i) {
      of.compliance(i, j) = of.compliance(j, i) = 0.5 * (of.compliance(i, j) + of.compliance(j, i));
    }
  }
  of.compliance.block(0, first, first, more) = of.compliance.block(first, 0, more, first).transpose();
}

// Takes from end_positions_ what the forces of the last step do to first order.
void Character::take_off_forces() {
  State& state = *state_;
  state.points_now.clear();
  for (const SkinForce& f : state.forces) state.points_now.push_back(f.point);
  state.touch(*assembly_.impl_, state.points_now);
  add_response(state.forces, -1.0);
}

// Adds `sign` times what forces on touched points do to the skin.
void Character::add_response(const std::vector<SkinForce>& forces, double sign) {
  State& state = *state_;
  for (State::Touched& group : state.touched) {
    group.force.head(3 * static_cast<Eigen::Index>(group.points.size())).setZero();
    group.used = false;
  }
  for (const SkinForce& f : forces) {
    const auto point = static_cast<std::size_t>(f.point);
    State::Touched& group = state.touched[static_cast<std::size_t>(state.skin[point].group)];
    group.force.segment<3>(3 * state.slot_of[point]) += sign * f.force;
    group.used = true;
  }
  for (std::size_t g = 0; g < state.touched.size(); ++g) {
    State::Touched& group = state.touched[g];
    if (!group.used) continue;
    const auto rows = 3 * static_cast<Eigen::Index>(group.points.size());
    group.joints.noalias() = group.columns.topRows(rows).transpose() * group.force.head(rows);
    state.shift_skin(*assembly_.impl_, g, end_positions_);
  }
  for (const SkinForce& f : forces) dent(f.point, sign * f.force);
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
  const Vec3 local = segment.rotation.transpose() * force;
  const Eigen::Index free = model.free_points();
  const Eigen::Map<const Eigen::MatrixXd> c(model.free_compliance.data(), 3 * free, 3 * free);
  for (Eigen::Index i = 0; i < free; ++i) {
    const auto v = static_cast<std::size_t>(model.free_vertices[static_cast<std::size_t>(i)]);
    Vec3 moved = Vec3::Zero();
    for (Eigen::Index a = 0; a < 3; ++a) {
      for (Eigen::Index b = 0; b < 3; ++b) moved[a] += c(a * free + i, b * free + at.free) * local[b];
    }
    end_positions_[static_cast<std::size_t>(names[v])] += segment.rotation * moved;
  }
}

// dv_i / dJ_j = C_ij / h^2: an impulse J is a force J/h, and what it moves by u moves at u/h.
void Character::compliance(std::span<const int> touched, double* blocks) {
  State& state = *state_;
  state.touch(*assembly_.impl_, touched);
  const auto count = static_cast<Eigen::Index>(touched.size());
  const double per_impulse = 1.0 / (state.dt * state.dt);
  Eigen::Map<Eigen::MatrixXd> c(blocks, 3 * count, 3 * count);
  c.setZero();
  for (Eigen::Index j = 0; j < count; ++j) {
    const auto from = static_cast<std::size_t>(touched[static_cast<std::size_t>(j)]);
    const int group = state.skin[from].group;
    const Eigen::MatrixXd& all = state.touched[static_cast<std::size_t>(group)].compliance;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto to = static_cast<std::size_t>(touched[static_cast<std::size_t>(i)]);
      if (state.skin[to].group != group) continue;
      c.block<3, 3>(3 * i, 3 * j) =
          per_impulse * all.block<3, 3>(3 * state.slot_of[to], 3 * state.slot_of[from]);
    }
    c.diagonal().segment<3>(3 * j).array() += per_impulse * held_give(static_cast<int>(from));
  }
}

void Character::respond(std::span<const int> touched, std::span<const Vec3> impulses) {
  State& state = *state_;
  state.responded = true;
  end_positions_ = free_positions_;
  state.forces_now.resize(touched.size());
  for (std::size_t j = 0; j < touched.size(); ++j) state.forces_now[j] = {touched[j], impulses[j] / state.dt};
  add_response(state.forces_now, 1.0);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
