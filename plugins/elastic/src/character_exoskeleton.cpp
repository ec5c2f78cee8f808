// A character and the exoskeleton it hangs on.
#include <Eigen/Geometry>
#include <Eigen/QR>

#include <algorithm>

#include "character_state.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Contact and handles may have moved the exoskeleton after the character was solved: the ends go with it, and
// the joints find their balance anew with the forces that the skin was found to bear.
void Character::follow_exoskeletons() {
  State& state = *state_;
  bool moved = state.postponed;
  for (const State::Attachment& a : state.attachments) {
    const Vec3 to =
        a.exoskeleton->points()[static_cast<std::size_t>(a.vertex)] + a.exoskeleton->frame_ * a.offset;
    const Assembly::Impl::Place place = assembly_.impl_->place_of(a.end);
    const PartGroup::Joint& joint = place.state->group.joints()[place.joint];
    moved = moved || place.state->group.point(place.state->x, 3 * joint.first, joint.count) != to;
    put_end(a.end, to);
  }
  if (!moved) return;
  solve_under_forces();
}

// Without the checks of move(): what an exoskeleton does is no input.
void Character::put_end(const PartEnd& end, const Vec3& to) {
  const Assembly::Impl::Place place = assembly_.impl_->place_of(end);
  const PartGroup::Joint& joint = place.state->group.joints()[place.joint];
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double& now = place.state->target[3 * joint.first + axis * joint.count];
    place.state->changed = place.state->changed || now != to[axis];
    now = to[axis];
  }
}

// Stiffness (N/m) that the ends of a group of parts show: the largest of their own, everything else
// following.
double Character::measure_end_stiffness(int g) {
  GroupState& group = *assembly_.impl_->groups[static_cast<std::size_t>(g)];
  double largest = 0;
  Eigen::VectorXd unit = Eigen::VectorXd::Zero(group.group.size());
  Eigen::VectorXd free = unit, force = unit;
  for (std::size_t j = 0; j < group.ends.size(); ++j) {
    if (group.ends[j] == Hold::kNothing) continue;
    const PartGroup::Joint& joint = group.group.joints()[j];
    for (Eigen::Index a = 0; a < 3; ++a) {
      const Eigen::Index at = 3 * joint.first + a * joint.count;
      unit.setZero();
      unit[at] = 1.0;
      group.group.stiffness_product(unit, force);
      free = -force;
      group.solver.respond(free.data(), 1, 1, state_->scratch);
      free += unit;
      group.group.stiffness_product(free, force);
      largest = std::max(largest, std::abs(force[at]));
    }
  }
  return largest;
}

// The reaction: the opposite of what holds the ends, and how it will change as the exoskeleton's vertices
// part, for the exoskeleton to take it implicitly. k (1 - 1/n) between the n ends of a group.
void Character::load_exoskeletons() {
  State& state = *state_;
  if (!settings_.reaction || state.attachments.empty()) return;
  Assembly::Impl& impl = *assembly_.impl_;
  for (std::size_t first = 0; first < state.attachments.size(); ++first) {
    ElasticBody* const exoskeleton = state.attachments[first].exoskeleton;
    const auto before = state.attachments.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::any_of(state.attachments.begin(), before,
                    [&](const auto& a) { return a.exoskeleton == exoskeleton; })) {
      continue;
    }
    state.loaded.clear();
    state.loads.clear();
    const auto slot_of = [&](int vertex) {
      const auto known = std::find(state.loaded.begin(), state.loaded.end(), vertex);
      const auto slot = static_cast<std::size_t>(known - state.loaded.begin());
      if (known == state.loaded.end()) {
        state.loaded.push_back(vertex);
        state.loads.push_back(Vec3::Zero());
      }
      return slot;
    };
    for (const State::Attachment& a : state.attachments) {
      if (a.exoskeleton == exoskeleton) state.loads[slot_of(a.vertex)] -= assembly_.force(a.end);
    }
    const std::size_t n = 3 * state.loaded.size();
    state.load_stiffness.assign(n * n, 0.0);
    for (std::size_t g = 0; g < impl.groups.size(); ++g) {
      double count = 0;
      const auto in_group = [&](const State::Attachment& a) {
        return a.exoskeleton == exoskeleton && impl.place_of(a.end).state == impl.groups[g].get();
      };
      for (const State::Attachment& a : state.attachments) count += in_group(a) ? 1.0 : 0.0;
      if (count < 2.0) continue;
      if (state.end_stiffness[g] == 0.0) state.end_stiffness[g] = measure_end_stiffness(static_cast<int>(g));
      for (const State::Attachment& a : state.attachments) {
        if (!in_group(a)) continue;
        for (const State::Attachment& b : state.attachments) {
          if (!in_group(b)) continue;
          const bool same = &a == &b;
          const double k = state.end_stiffness[g] * ((same ? 1.0 : 0.0) - 1.0 / count);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t row = 3 * slot_of(a.vertex) + axis, column = 3 * slot_of(b.vertex) + axis;
            state.load_stiffness[column * n + row] += k;
          }
        }
      }
    }
    steady_grounded(*exoskeleton);
    exoskeleton->set_point_loads(state.loaded, state.loads, state.load_stiffness);
  }
}

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

// Velocity at `arm` by velocity and angular velocity.
Eigen::Matrix<double, 3, 6> lever(const Vec3& arm) {
  Eigen::Matrix<double, 3, 6> j;
  j.leftCols<3>().setIdentity();
  j.rightCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return j;
}

}  // namespace

// Parts that touch something tie the exoskeleton to it, and forces that answer only in the next step would
// throw it about: force and moment on the body as a whole are taken at the end of the step instead,
//   W' = (1 + h^2 K M^-1)^-1 [W - h K (V + h a - h M^-1 W_0)],
// with V its velocities, a and W_0 its acceleration and what it felt in the last step. At rest W' = W
// whatever K, which is that of the ends with everything round them held: more than the true one.
void Character::steady_grounded(ElasticBody& exoskeleton) {
  State& state = *state_;
  const Assembly::Impl& impl = *assembly_.impl_;
  const Vec3 center = exoskeleton.center_of_mass();
  state.arms.assign(exoskeleton.points().begin(), exoskeleton.points().end());
  for (Vec3& arm : state.arms) arm -= center;
  const Mat3 inverse = exoskeleton.inverse_inertia(state.arms);
  Vector6 velocity, wrench = Vector6::Zero();
  velocity << exoskeleton.momentum() / exoskeleton.total_mass(),
      inverse * exoskeleton.angular_momentum(center);
  Matrix6 mobility = Matrix6::Zero(), stiffness = Matrix6::Zero(), spread = Matrix6::Zero();
  mobility.topLeftCorner<3, 3>() = Mat3::Identity() / exoskeleton.total_mass();
  mobility.bottomRightCorner<3, 3>() = inverse;
  for (std::size_t i = 0; i < state.loaded.size(); ++i) {
    const auto j = lever(state.arms[static_cast<std::size_t>(state.loaded[i])]);
    wrench += j.transpose() * state.loads[i];
    spread += j.transpose() * j;
  }
  State::Feeling& felt = state.feeling_of(exoskeleton);
  const std::size_t n = 3 * state.loaded.size();
  bool grounded = false;
  for (const State::Attachment& a : state.attachments) {
    if (a.exoskeleton != &exoskeleton) continue;
    const Assembly::Impl::Place place = impl.place_of(a.end);
    const auto touches = [&](const SkinForce& f) {
      return impl.groups[static_cast<std::size_t>(state.skin[static_cast<std::size_t>(f.point)].group)]
                 .get() == place.state;
    };
    if (std::none_of(state.forces.begin(), state.forces.end(), touches)) continue;
    grounded = true;
    const double k = place.state->group.point_stiffness(place.joint);
    const auto j = lever(state.arms[static_cast<std::size_t>(a.vertex)]);
    stiffness += k * j.transpose() * j;
    const auto slot = static_cast<std::size_t>(std::find(state.loaded.begin(), state.loaded.end(), a.vertex) -
                                               state.loaded.begin());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      state.load_stiffness[(3 * slot + axis) * n + 3 * slot + axis] += k;
    }
  }
  const double h = state.dt;
  Vector6 taken = wrench;
  if (grounded && felt.known) {
    const Vector6 free = velocity + (velocity - felt.velocity) - h * mobility * felt.wrench;
    taken = (Matrix6::Identity() + h * h * stiffness * mobility)
                .colPivHouseholderQr()
                .solve(wrench - h * stiffness * free);
    const Vector6 share = spread.completeOrthogonalDecomposition().solve(taken - wrench);
    for (std::size_t i = 0; i < state.loaded.size(); ++i) {
      state.loads[i] += lever(state.arms[static_cast<std::size_t>(state.loaded[i])]) * share;
    }
  }
  felt = {&exoskeleton, true, velocity, taken};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
