#pragma once

#include "lane_body.h"

// No standard library here: walks built for other instruction sets include it.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// Sums where limbs meet: to each lane of a row is added what another lane holds.
struct LimbSum {
  const long long* from;  // lane, one a lane
  const long long* mask;  // all bits, or none
};

// One forward dynamics of a figure with its limbs side by side: see LimbPlan. Arrays of packs: number k of
// lane l stands at [k * lanes + l]; what is read and written as packs is aligned to 64 bytes.
struct LimbBlock {
  const LaneStep* steps;  // one a row; q and v count packs
  int rows;
  const double* bodies;   // LaneBody<Pack>, one a row
  const int* sum_begins;  // per row, and one more: into `sums`
  const LimbSum* sums;
  const int* q_index;    // one a lane of each pack of positions
  const double* q_live;  // 0 in lanes that have no joint there
  int q_packs;
  const int* v_index;
  const double* v_live;
  int v_packs;
  const int* result;  // per degree of freedom: where in the packs of accelerations it stands
  int dofs;
  const double* world;  // 3, m/s2: its acceleration less gravity
  const double* q;
  const double* qd;
  const double* tau;  // null: zero
  double* qdd;
  double* work;  // scratch: see LimbWalker
};

// Sizes in doubles. The scratch holds a load, then a pose and a work a row, then 3 packs a degree of freedom
// of a row and one a position.
struct LimbWalker {
  int lanes = 0;  // 0: there is none
  int load_size = 0, pose_size = 0, work_size = 0;
  void (*forward)(const LimbBlock& block) = nullptr;
};

LimbWalker limb_walker_avx2();
LimbWalker limb_walker_avx512();

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
