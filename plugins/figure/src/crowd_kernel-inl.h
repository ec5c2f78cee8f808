// Forward dynamics of a block of figures, the walks of FigureDynamics with packs as scalars. Included once a
// file, after SOFTPOINT_KERNEL_NAME and SOFTPOINT_KERNEL_LANES are set and the instruction set is chosen. The
// templates' names hold the width of the packs, so that the linker never merges copies of different
// instruction sets.
#include "articulated-inl.h"
#include "crowd_kernel.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

typedef double Pack __attribute__((vector_size(8 * SOFTPOINT_KERNEL_LANES)));

void SOFTPOINT_KERNEL_FORWARD(const CrowdBlock& block) {
  const Pack* q = reinterpret_cast<const Pack*>(block.q);
  const Pack* qd = reinterpret_cast<const Pack*>(block.qd);
  Pack* torque = reinterpret_cast<Pack*>(block.torque);
  Pack* qdd = reinterpret_cast<Pack*>(block.qdd);
  BodyWork<Pack>* work = reinterpret_cast<BodyWork<Pack>*>(block.work);
  BallWork<Pack>* balls = reinterpret_cast<BallWork<Pack>*>(work + block.count);
  const Pack zero{};
  WorldFrame<Pack> world;
  world.acceleration = {{zero, zero, zero},
                        {zero - block.gravity[0], zero - block.gravity[1], zero - block.gravity[2]}};
  for (int i = 0; i < block.count; ++i) {
    const TreeBody& body = block.bodies[i];
    place_body(body, body.parent < 0 ? nullptr : work + body.parent, q, qd, work[i]);
    if (body.damping > 0) {
      const int dofs = body.joint == JointKind::kBall ? 3 : 1;  // a free joint has none
      for (int k = body.v; k < body.v + dofs; ++k) torque[k] -= body.damping * qd[k];
    }
  }
  for (int i = block.count - 1; i >= 0; --i) {
    const TreeBody& body = block.bodies[i];
    // Weighed here, not outward: a crowd's work is larger than the nearest cache.
    BodyWork<Pack>& own = work[i];
    if (body.leaf) {
      weigh(body, own);
    } else if (!body.massless) {
      const Inertia6<Pack> borne = own.inertia;
      const V6<Pack> bias = own.bias;
      weigh(body, own);
      own.inertia += borne;
      own.bias = own.bias + bias;
    }
    yield(body, body.armature, torque, own, balls[body.ball]);
    if (body.parent < 0) continue;
    BodyWork<Pack>& parent = work[body.parent];
    if (body.leans_first) {
      parent.inertia = shifted(own.inertia, own.arm);
      parent.bias = {own.bias.turn + cross(own.arm, own.bias.move), own.bias.move};
    } else {
      lean(own, parent);
    }
  }
  for (int i = 0; i < block.count; ++i) {
    const TreeBody& body = block.bodies[i];
    answer(body, body.parent < 0 ? world.acceleration : work[body.parent].acceleration, world, work[i],
           balls[body.ball], qdd);
  }
}

}  // namespace

CrowdKernel SOFTPOINT_KERNEL_NAME() {
  return {SOFTPOINT_KERNEL_LANES, static_cast<int>(sizeof(BodyWork<Pack>) / sizeof(double)),
          static_cast<int>(sizeof(BallWork<Pack>) / sizeof(double)), SOFTPOINT_KERNEL_FORWARD};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
