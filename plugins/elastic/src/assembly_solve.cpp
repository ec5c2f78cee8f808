// How an assembly finds its shape: bones first, then joints, then skin.
#include <Eigen/Geometry>

#include <algorithm>
#include <cstring>

#include "assembly_impl.h"
#include "inverse_kinematics.h"
#include "rotation_fit.h"
#include "softpoint/core/error.h"
#include "stopwatch.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {
namespace {

// Ends that move farther than this part of a segment within a step let inverse kinematics begin.
constexpr double kFar = 0.25;
// What joints did on their own in the last solve they are taken to do again, if it is no more than this part
// of a segment and not many times what their holders do: at rest nothing may drift within the tolerance.
constexpr double kSmall = 0.05;
constexpr double kLed = 4.0;

void put(Eigen::VectorXd& v, Eigen::Index at, Eigen::Index stride, const Vec3& value) {
  for (Eigen::Index a = 0; a < 3; ++a) v[at + a * stride] = value[a];
}

// Moves all points of a joint that are not held as a rigid body: `from` goes to `to`.
void carry(GroupState& state, std::size_t j, const Vec3& from, const Vec3& to, const Mat3& turn) {
  const PartGroup::Joint& joint = state.group.joints()[j];
  for (Eigen::Index i = 0; i < joint.count; ++i) {
    if (state.held[static_cast<std::size_t>(joint.first + i)] != 0) continue;
    const Eigen::Index at = 3 * joint.first + i;
    put(state.x, at, joint.count, to + turn * (state.group.point(state.x, at, joint.count) - from));
  }
}

}  // namespace

void Assembly::Impl::factor(GroupState& state) {
  state.solver.prepare(state.held, state.inertia);
  state.factored = true;
}

double Assembly::Impl::kappa_of(const GroupState& state) const {
  // Mass makes joints stiffer than when kappa was checked.
  const double limit = 1.0 / state.solver.greatest_stiffness();
  return settings.kappa > 0.0 ? std::min(settings.kappa, 1.9 * limit) : limit;
}

// Bones follow their ends by inverse kinematics, and joints their bones. Bones whose ends are all held or
// loose go first, so that what is joined to them finds its root.
int Assembly::Impl::predict_bones(GroupState& state) {
  PartGroup& group = state.group;
  int sweeps = 0;
  for (const bool joined : {false, true}) {
    for (const PartGroup::Bone& bone : group.bones()) {
      const std::size_t n = bone.at.size();
      const auto& row = placed.part_joints[static_cast<std::size_t>(bone.part)];
      const auto joint_at = [&](std::size_t i) {
        return static_cast<std::size_t>(joint_places[static_cast<std::size_t>(row[i])][1]);
      };
      const auto held_at = [&](std::size_t i) { return state.ends[joint_at(i)] != Hold::kNothing; };
      const auto joined_at = [&](std::size_t i) { return group.joints()[joint_at(i)].segments[1] >= 0; };
      if ((joined_at(0) || joined_at(n - 1)) != joined) continue;
      for (std::size_t i = 0; i < n; ++i) {
        bone_now[i] = bone_next[i] = group.point(state.before, bone.at[i], bone.stride[i]);
      }
      // `x` has the held ends in their new places already, and joined ones where their part carried them.
      const Vec3 root = group.point(state.x, bone.at[0], bone.stride[0]);
      const Vec3 tip = group.point(state.x, bone.at[n - 1], bone.stride[n - 1]);
      const bool root_known = held_at(0) || joined_at(0), tip_known = held_at(n - 1) || joined_at(n - 1);
      if (!root_known && !tip_known) continue;
      if (root_known && tip_known) {
        sweeps += place_bone({bone_next.data(), n}, root, tip, settings.ik_sweeps, 1e-3 * group.spacing());
      } else {
        const Vec3 shift = root_known ? Vec3(root - bone_now[0]) : Vec3(tip - bone_now[n - 1]);
        for (std::size_t i = 0; i < n; ++i) bone_next[i] += shift;
      }
      const auto edge_turn = [&](std::size_t i) {
        return turn_between(bone_now[i + 1] - bone_now[i], bone_next[i + 1] - bone_next[i]);
      };
      for (std::size_t i = 0; i < n; ++i) {
        if (joined_at(i) && (i == 0 || i == n - 1)) continue;
        const Vec3 old_along = (bone_now[std::min(i + 1, n - 1)] - bone_now[i > 0 ? i - 1 : 0]);
        const Vec3 new_along = (bone_next[std::min(i + 1, n - 1)] - bone_next[i > 0 ? i - 1 : 0]);
        carry(state, joint_at(i), bone_now[i], bone_next[i], turn_between(old_along, new_along));
      }
      const auto first = static_cast<std::size_t>(placed.first_segment[static_cast<std::size_t>(bone.part)]);
      for (std::size_t k = 0; k + 1 < n; ++k) {
        const PlacedSegment& segment = placed.segments[first + k];
        for (std::size_t i = 2; i < segment.joint.size(); ++i) {
          carry(state, static_cast<std::size_t>(joint_places[static_cast<std::size_t>(segment.joint[i])][1]),
                bone_now[k], bone_next[k], edge_turn(k));
        }
      }
    }
  }
  return sweeps;
}

// Held points go to their targets, and all others along with them as one rigid body, as far as the held ones
// move as one: about the line of two of them nothing turns. Returns how far the farthest went.
double Assembly::Impl::carry_along(GroupState& state) {
  const PartGroup& group = state.group;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double count = 0, farthest = 0;
  const auto holds_some = [&](const PartGroup::Joint& joint) {
    return std::memchr(state.held.data() + joint.first, 1, static_cast<std::size_t>(joint.count)) != nullptr;
  };
  const auto each_held_point = [&](const auto& visit) {
    for (const PartGroup::Joint& joint : group.joints()) {
      if (!holds_some(joint)) continue;
      for (Eigen::Index i = 0; i < joint.count; ++i) {
        if (state.held[static_cast<std::size_t>(joint.first + i)] != 0)
          visit(3 * joint.first + i, joint.count);
      }
    }
  };
  each_held_point([&](Eigen::Index at, Eigen::Index stride) {
    const Vec3 old = group.point(state.x, at, stride), next = group.point(state.target, at, stride);
    farthest = std::max(farthest, (next - old).norm());
    from += old;
    to += next;
    count += 1.0;
  });
  if (!(farthest > 0.0)) return 0.0;
  from /= count;
  to /= count;
  Mat3 moment = Mat3::Zero();
  each_held_point([&](Eigen::Index at, Eigen::Index stride) {
    moment +=
        (group.point(state.target, at, stride) - to) * (group.point(state.x, at, stride) - from).transpose();
    put(state.x, at, stride, group.point(state.target, at, stride));
  });
  const double size = moment.norm();
  const Mat3 turn =
      size > 0.0 ? nearest_rotation(moment / size + 1e-6 * Mat3::Identity()) : Mat3(Mat3::Identity());
  for (PartGroup::Segment& segment : state.group.segments()) segment.rotation = turn * segment.rotation;
  for (const PartGroup::Joint& joint : group.joints()) {
    const bool some = holds_some(joint);
    const Eigen::Index n = joint.count;
    double* const x = state.x.data() + 3 * joint.first;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (some && state.held[static_cast<std::size_t>(joint.first + i)] != 0) continue;
      const double dx = x[i] - from.x(), dy = x[n + i] - from.y(), dz = x[2 * n + i] - from.z();
      x[i] = to.x() + (turn(0, 0) * dx + turn(0, 1) * dy + turn(0, 2) * dz);
      x[n + i] = to.y() + (turn(1, 0) * dx + turn(1, 1) * dy + turn(1, 2) * dz);
      x[2 * n + i] = to.z() + (turn(2, 0) * dx + turn(2, 1) * dy + turn(2, 2) * dz);
    }
  }
  return farthest;
}

void Assembly::Impl::find_forces(GroupState& state) {
  if (!state.forces_due) return;
  state.energy = state.solver.evaluate(state.x, state.toward);
  state.forces_due = false;
}

// Shapes that change steadily do so by the same small steps.
void Assembly::Impl::go_on(GroupState& state, double led) {
  const double most = state.settled.cwiseAbs().maxCoeff();
  if (!(most > 0.0 && most < std::min(kSmall * state.group.spacing(), kLed * led))) return;
  for (const PartGroup::Joint& joint : state.group.joints()) {
    for (Eigen::Index i = 0; i < joint.count; ++i) {
      if (state.held[static_cast<std::size_t>(joint.first + i)] != 0) continue;
      for (Eigen::Index a = 0; a < 3; ++a) {
        const Eigen::Index at = 3 * joint.first + a * joint.count + i;
        state.x[at] += state.settled[at];
      }
    }
  }
}

void Assembly::Impl::solve_group(GroupState& state) {
  if (!state.factored) factor(state);
  PartGroup& group = state.group;
  state.before = state.x;
  const double farthest = carry_along(state);
  if (settings.predictor == Predictor::kInverseKinematics ||
      (settings.predictor == Predictor::kAutomatic && farthest > kFar * group.spacing())) {
    for (const PartGroup::Joint& joint : group.joints()) {
      for (Eigen::Index i = 0; i < joint.count; ++i) {
        if (state.held[static_cast<std::size_t>(joint.first + i)] != 0) continue;
        const Eigen::Index at = 3 * joint.first + i;
        put(state.x, at, joint.count, group.point(state.before, at, joint.count));
      }
    }
    report.ik_sweeps += predict_bones(state);
  }
  if (settings.max_iterations == 0) {
    group.fit_all(state.x);
    state.forces_due = true;
    state.changed = false;
    report.balanced = false;
    return;
  }
  if (state.dragged) state.toward = state.x;  // from where the parts were carried
  state.carried = state.x;
  go_on(state, farthest);
  const long long products = group.products;
  const JointSolver::Outcome outcome = state.solver.solve(settings, kappa_of(state), state.x, state.toward);
  if (outcome.balanced) {
    state.settled = state.x - state.carried;
  } else {
    state.settled.setZero();  // on its way to somewhere else
  }
  state.energy = outcome.energy;
  state.forces_due = false;
  report.products += group.products - products;
  report.iterations += outcome.iterations;
  report.evaluations += outcome.evaluations;
  report.residual = std::max(report.residual, outcome.residual);
  report.largest_turn = std::max(report.largest_turn, group.largest_turn());
  report.balanced = report.balanced && outcome.balanced;
  state.changed = !outcome.balanced;
}

void Assembly::solve() {
  Impl& impl = *impl_;
  AssemblyReport& report = impl.report;
  report = {};
  report.groups = static_cast<int>(impl.groups.size());
  report.segments = static_cast<int>(impl.placed.segments.size());
  Stopwatch watch;
  for (const auto& state : impl.groups) {
    state->solved = state->changed;
    if (!state->changed) continue;
    ++report.groups_solved;
    impl.solve_group(*state);
  }
  report.solve_seconds = watch.lap();
  for (const auto& state : impl.groups) {
    if (state->solved) impl.skin(*state);
  }
  report.skin_seconds = watch.lap();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
