#pragma once

#include <algorithm>

#include "forward_walk.h"
#include "lane_convert.h"
#include "limb_plan.h"
#include "matrix_forward.h"
#include "response-inl.h"
#include "softpoint/core/instruction_set.h"
#include "softpoint/figure/figure_dynamics.h"
#include "walk_plan.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {

struct __attribute__((visibility("hidden"))) FigureDynamics::Impl {
  explicit Impl(const FigureModel& of)
      : model(of), tree(build_tree(of)), plan(tree), limbs(tree, best_instruction_set()) {
    work.resize(tree.bodies.size());
    balls.resize(static_cast<std::size_t>(std::max(tree.balls, 1)));
    const auto n = static_cast<std::size_t>(std::max(model.velocity_count(), 1));
    torque.resize(n);
    zero.resize(n);
    unit.resize(n);
    reply.resize(tree.bodies.size());
    positions.resize(tree.bodies.size());
    velocities.resize(tree.bodies.size());
    squared_rates.resize(tree.bodies.size());
  }

  const BodyWork<double>* parent_of(const TreeBody& body) const {
    return body.parent < 0 ? nullptr : &work[static_cast<std::size_t>(body.parent)];
  }
  const V6<double>& acceleration_of(int body) const {
    return body < 0 ? world.acceleration : work[static_cast<std::size_t>(body)].acceleration;
  }
  // A load at the joint of the body that carries the link.
  V6<double> at_joint(const Wrench& load, int& body) const {
    const LinkPlace& place = tree.places[static_cast<std::size_t>(load.link)];
    body = place.body;
    V6<double> wrench{lanes(load.moment), lanes(load.force)};
    if (body >= 0) {
      const V3<double> arm = work[static_cast<std::size_t>(body)].axes * place.origin;
      wrench.turn = wrench.turn + cross(arm, wrench.move);
    }
    return wrench;
  }
  void set_world() { world.acceleration = {{0, 0, 0}, lanes(Vec3(base_acceleration - gravity))}; }
  void bear(std::span<const Wrench> loads) {
    for (const Wrench& load : loads) {
      int body = -1;
      const V6<double> wrench = at_joint(load, body);
      if (body >= 0)
        work[static_cast<std::size_t>(body)].bias = work[static_cast<std::size_t>(body)].bias - wrench;
    }
  }

  // What the last forward dynamics has left in packs, where everything else looks for it.
  void unpack_limbs() {
    if (!in_packs) return;
    in_packs = false;
    limbs.unpack(work);
  }

  // (8) for the wrenches in `reply` and for torques.
  void respond(const double* tau, double* change);

  FigureModel model;
  std::unique_ptr<MatrixForward> matrix;  // of that method alone
  Tree tree;
  WalkPlan plan;
  LimbPlan limbs;
  bool in_packs = false;  // the last forward dynamics went by limbs, and nothing is in `work` yet
  Vec3 gravity{0, 0, -9.81};
  Vec3 base_acceleration = Vec3::Zero();
  double implicit_time = 0;
  WorldFrame<double> world{};
  ForwardWalker walker =
      best_instruction_set() == InstructionSet::kBaseline ? forward_walker_baseline() : forward_walker_avx2();
  std::vector<BodyWork<double>> work;
  std::vector<BallWork<double>> balls;
  std::vector<double> torque, zero, unit;
  std::vector<V6<double>> reply;  // per body: wrench, then acceleration, of respond()
  // After place(), per body: its joint's position (m) and velocity (m/s), the square of the joint's own
  // rates.
  std::vector<V3<double>> positions, velocities;
  std::vector<double> squared_rates;
  Counts counts;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
