// Forward dynamics of a block of figures: the walks of lane_walk-inl.h with a figure in every lane. Included
// once a file, after SOFTPOINT_KERNEL_NAME and SOFTPOINT_KERNEL_LANES are set and the instruction set is
// chosen. The templates' names hold the width of the packs, so that the linker never merges copies of
// different instruction sets.
#include "crowd_kernel.h"
#include "lane_walk-inl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

typedef double Pack __attribute__((vector_size(8 * SOFTPOINT_KERNEL_LANES)));

// What lives in a slot: on the way outward, inward, and outward again.
union Slot {
  LanePose<Pack> pose;
  LaneLoad<Pack> load;
  V6<Pack> acceleration;
};

__attribute__((flatten)) void SOFTPOINT_KERNEL_FORWARD(const CrowdBlock& block) {
  const Pack* q = reinterpret_cast<const Pack*>(block.q);
  const Pack* qd = reinterpret_cast<const Pack*>(block.qd);
  const Pack* tau = reinterpret_cast<const Pack*>(block.tau);
  Pack* qdd = reinterpret_cast<Pack*>(block.qdd);
  Slot* slots = reinterpret_cast<Slot*>(block.work);
  LaneWork<Pack>* work = reinterpret_cast<LaneWork<Pack>*>(slots + block.slots);
  LaneBall<Pack>* balls = reinterpret_cast<LaneBall<Pack>*>(work + block.count);
  const Pack zero{};
  const Pack one = zero + 1.0;
  const V3<Pack> none{zero, zero, zero};
  const LanePose<Pack> world{{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}},
                             none,
                             none,
                             {zero - block.gravity[0], zero - block.gravity[1], zero - block.gravity[2]},
                             {none, none, none}};
  for (int i = 0; i < block.count; ++i) {
    const LaneStep& step = block.steps[i];
    lane_place(step, block.bodies[i], step.root ? world : slots[step.parent_slot].pose, q, qd,
               slots[step.slot].pose, work[i], balls);
  }
  for (int i = block.count - 1; i >= 0; --i) {
    const LaneStep& step = block.steps[i];
    LaneLoad<Pack>& load = slots[step.slot].load;
    lane_gather(step, block.bodies[i], work[i], load);
    lane_yield(step, block.bodies[i], tau, qd, work[i], balls, load);
    if (!step.root) lane_lean(step, work[i], load, slots[step.parent_slot].load);
  }
  const V6<Pack> still{none, none};
  for (int i = 0; i < block.count; ++i) {
    const LaneStep& step = block.steps[i];
    lane_answer(step, work[i], balls, step.root ? still : slots[step.parent_slot].acceleration,
                slots[step.slot].acceleration, qdd);
  }
}

}  // namespace

CrowdKernel SOFTPOINT_KERNEL_NAME() {
  return {SOFTPOINT_KERNEL_LANES, static_cast<int>(sizeof(Slot) / sizeof(double)),
          static_cast<int>(sizeof(LaneWork<Pack>) / sizeof(double)),
          static_cast<int>(sizeof(LaneBall<Pack>) / sizeof(double)), SOFTPOINT_KERNEL_FORWARD};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
