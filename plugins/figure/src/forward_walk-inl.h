// The walks of a forward dynamics for one figure. Included once a file, after SOFTPOINT_WALK and
// SOFTPOINT_WALK_SCALAR are set and the instruction set is chosen: the scalar is a type of the file's own, so
// that the linker never merges templates of different instruction sets.
#include "forward_walk.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

using SOFTPOINT_WALK_SCALAR;

void place_figure(const ForwardWalk& walk) {
  const Scalar* q = reinterpret_cast<const Scalar*>(walk.q);
  const Scalar* qd = reinterpret_cast<const Scalar*>(walk.qd);
  const Scalar* qdd = reinterpret_cast<const Scalar*>(walk.qdd);
  BodyWork<Scalar>* all = reinterpret_cast<BodyWork<Scalar>*>(walk.work);
  const V6<Scalar>& world = *reinterpret_cast<const V6<Scalar>*>(walk.world);
  for (int n = 0; n < walk.placed_count; ++n) {
    const int i = walk.placed[n];
    const TreeBody& body = walk.bodies[i];
    BodyWork<Scalar>& work = all[i];
    place_body(body, body.parent < 0 ? nullptr : all + body.parent, q, qd, work);
    if (!walk.dynamic[i]) accelerate(body, work, qdd, work.drift);
    if (!walk.bears[i]) {
      work.acceleration = carried(body.parent < 0 ? world : all[body.parent].acceleration, work);
      continue;
    }
    weigh(body, work);
    if (!walk.dynamic[i]) continue;
    for (int k = body.v; k < body.v + body.dofs; ++k) {
      walk.torque[k] = (walk.tau == nullptr ? 0.0 : walk.tau[k]) - body.damping * walk.qd[k];
    }
  }
}

void solve_figure(const ForwardWalk& walk) {
  BodyWork<Scalar>* all = reinterpret_cast<BodyWork<Scalar>*>(walk.work);
  BallWork<Scalar>* balls = reinterpret_cast<BallWork<Scalar>*>(walk.balls);
  const Scalar* torque = reinterpret_cast<const Scalar*>(walk.torque);
  Scalar* qdd = reinterpret_cast<Scalar*>(walk.qdd);
  const WorldFrame<Scalar> world{*reinterpret_cast<const V6<Scalar>*>(walk.world)};
  for (int n = walk.articulated_count; n-- > 0;) {
    const int i = walk.articulated[n];
    const TreeBody& body = walk.bodies[i];
    if (walk.dynamic[i]) {
      yield(body, body.armature + walk.implicit_time * body.damping, torque, all[i], balls[body.ball]);
    } else {
      carry(all[i]);
    }
    if (body.parent >= 0 && walk.bears[body.parent]) lean(body, all[i], all[body.parent]);
  }
  for (int n = 0; n < walk.articulated_count; ++n) {
    const int i = walk.articulated[n];
    const TreeBody& body = walk.bodies[i];
    const V6<Scalar>& parent = body.parent < 0 ? world.acceleration : all[body.parent].acceleration;
    if (walk.dynamic[i]) {
      answer(body, parent, world, all[i], balls[body.ball], qdd);
    } else {
      all[i].acceleration = carried(parent, all[i]);
    }
  }
}

}  // namespace

ForwardWalker SOFTPOINT_WALK() { return {place_figure, solve_figure}; }

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
