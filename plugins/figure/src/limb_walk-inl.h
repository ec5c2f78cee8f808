// Forward dynamics of a figure with its limbs in the lanes of packs. Included once a file, after
// SOFTPOINT_LIMB_NAME, SOFTPOINT_LIMB_FORWARD and SOFTPOINT_LIMB_LANES are set and the instruction set is
// chosen.
#include "lane_walk-inl.h"
#include "limb_walk.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr int kLanes = SOFTPOINT_LIMB_LANES;
typedef double Pack __attribute__((vector_size(8 * SOFTPOINT_LIMB_LANES)));
typedef long long PackMask __attribute__((vector_size(8 * SOFTPOINT_LIMB_LANES)));

inline Pack picked(const double* from, const int* index) {
#if SOFTPOINT_LIMB_LANES == 4
  return Pack{from[index[0]], from[index[1]], from[index[2]], from[index[3]]};
#else
  return Pack{from[index[0]], from[index[1]], from[index[2]], from[index[3]],
              from[index[4]], from[index[5]], from[index[6]], from[index[7]]};
#endif
}

// The lanes of `value` that meet, added to it.
struct Meeting {
  PackMask from, mask;
  Pack operator()(const Pack& value, const Pack& sum) const {
    return sum + reinterpret_cast<Pack>(reinterpret_cast<PackMask>(__builtin_shuffle(value, from)) & mask);
  }
  void operator()(const V3<Pack>& value, V3<Pack>& sum) const {
    sum.x = (*this)(value.x, sum.x);
    sum.y = (*this)(value.y, sum.y);
    sum.z = (*this)(value.z, sum.z);
  }
  void operator()(const S3<Pack>& value, S3<Pack>& sum) const {
    sum.xx = (*this)(value.xx, sum.xx);
    sum.xy = (*this)(value.xy, sum.xy);
    sum.xz = (*this)(value.xz, sum.xz);
    sum.yy = (*this)(value.yy, sum.yy);
    sum.yz = (*this)(value.yz, sum.yz);
    sum.zz = (*this)(value.zz, sum.zz);
  }
};

void meet(const LimbSum* sums, int count, LaneLoad<Pack>& load) {
  const LaneLoad<Pack> apart = load;
  for (int n = 0; n < count; ++n) {
    const Meeting add{*reinterpret_cast<const PackMask*>(sums[n].from),
                      *reinterpret_cast<const PackMask*>(sums[n].mask)};
    add(apart.inertia.turn, load.inertia.turn);
    add(apart.inertia.couple.x, load.inertia.couple.x);
    add(apart.inertia.couple.y, load.inertia.couple.y);
    add(apart.inertia.couple.z, load.inertia.couple.z);
    add(apart.inertia.move, load.inertia.move);
    add(apart.bias.turn, load.bias.turn);
    add(apart.bias.move, load.bias.move);
  }
}

__attribute__((flatten)) void SOFTPOINT_LIMB_FORWARD(const LimbBlock& block) {
  LaneLoad<Pack>& load = *reinterpret_cast<LaneLoad<Pack>*>(block.work);
  LanePose<Pack>* poses = reinterpret_cast<LanePose<Pack>*>(&load + 1);
  LaneWork<Pack>* work = reinterpret_cast<LaneWork<Pack>*>(poses + block.rows);
  Pack* q = reinterpret_cast<Pack*>(work + block.rows);
  Pack* qd = q + block.q_packs;
  Pack* tau = qd + block.v_packs;
  Pack* qdd = tau + block.v_packs;
  const LaneBody<Pack>* bodies = reinterpret_cast<const LaneBody<Pack>*>(block.bodies);
  const Pack zero{};
  const Pack* q_live = reinterpret_cast<const Pack*>(block.q_live);
  const Pack* v_live = reinterpret_cast<const Pack*>(block.v_live);
  for (int k = 0; k < block.q_packs; ++k) q[k] = picked(block.q, block.q_index + kLanes * k) * q_live[k];
  for (int k = 0; k < block.v_packs; ++k) {
    const int* index = block.v_index + kLanes * k;
    qd[k] = picked(block.qd, index) * v_live[k];
    tau[k] = block.tau == nullptr ? zero : picked(block.tau, index);
  }
  const Pack one = zero + 1.0;
  const V3<Pack> none{zero, zero, zero};
  const LanePose<Pack> world{{{one, zero, zero}, {zero, one, zero}, {zero, zero, one}},
                             none,
                             none,
                             {zero + block.world[0], zero + block.world[1], zero + block.world[2]},
                             {none, none, none}};
  for (int i = 0; i < block.rows; ++i) {
    lane_place(block.steps[i], bodies[i], i == 0 ? world : poses[i - 1], q, qd, poses[i], work[i],
               static_cast<LaneBall<Pack>*>(nullptr));
  }
  for (int i = block.rows - 1; i >= 0; --i) {
    const int sums = block.sum_begins[i + 1] - block.sum_begins[i];
    if (sums > 0) meet(block.sums + block.sum_begins[i], sums, load);
    lane_gather(block.steps[i], bodies[i], work[i], load);
    lane_yield(block.steps[i], bodies[i], tau, qd, work[i], static_cast<LaneBall<Pack>*>(nullptr), load);
    if (i > 0 && block.steps[i].armed) lane_shift(work[i].arm, load);
  }
  V6<Pack> a{none, none};
  for (int i = 0; i < block.rows; ++i) {
    lane_answer(block.steps[i], work[i], static_cast<const LaneBall<Pack>*>(nullptr), a, a, qdd);
  }
  const double* results = reinterpret_cast<const double*>(qdd);
  for (int k = 0; k < block.dofs; ++k) block.qdd[k] = results[block.result[k]];
}

}  // namespace

LimbWalker SOFTPOINT_LIMB_NAME() {
  return {kLanes, static_cast<int>(sizeof(LaneLoad<Pack>) / sizeof(double)),
          static_cast<int>(sizeof(LanePose<Pack>) / sizeof(double)),
          static_cast<int>(sizeof(LaneWork<Pack>) / sizeof(double)), SOFTPOINT_LIMB_FORWARD};
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
