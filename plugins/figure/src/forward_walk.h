#pragma once

#include "articulated-inl.h"

// No standard library here: walks built for other instruction sets include it.
namespace softpoint::inline SOFTPOINT_ABI::figure {

// One forward dynamics: the arrays of FigureDynamics.
struct ForwardWalk {
  const TreeBody* bodies;
  const int* placed;  // parents first
  int placed_count;
  const int* articulated;
  int articulated_count;
  const char* dynamic;  // per body
  const char* bears;
  const V6<double>* world;  // its acceleration less gravity
  double implicit_time;
  const double* q;
  const double* qd;
  const double* tau;  // null: zero
  double* torque;     // scratch
  double* qdd;
  BodyWork<double>* work;
  BallWork<double>* balls;
};

// Poses, motion and inertias of the bodies; then the rest, after loads were put on them.
struct ForwardWalker {
  void (*place)(const ForwardWalk& walk);
  void (*solve)(const ForwardWalk& walk);
};

ForwardWalker forward_walker_baseline();
ForwardWalker forward_walker_avx2();

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
