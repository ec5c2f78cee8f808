#include "solver_tap.h"

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// setConstraintSolver frees a solver the world made for itself; whether it did is a protected member.
struct Ownership : btDiscreteDynamicsWorld {
  static bool& of(btDiscreteDynamicsWorld& world) { return world.*(&Ownership::m_ownsConstraintSolver); }
};

}  // namespace

SolverTap::SolverTap(btDiscreteDynamicsWorld& world, SolvedListener& listener)
    : world_(world),
      listener_(listener),
      original_(world.getConstraintSolver()),
      world_owned_it_(Ownership::of(world)) {
  if (dynamic_cast<SolverTap*>(original_) != nullptr) {
    throw Error("DeformableSystem: this world already has one; permitted is one per world");
  }
  Ownership::of(world_) = false;
  world_.setConstraintSolver(this);
}

SolverTap::~SolverTap() {
  if (world_.getConstraintSolver() == this) {
    world_.setConstraintSolver(original_);
    Ownership::of(world_) = world_owned_it_;
  }
}

void SolverTap::prepareSolve(int bodies, int manifolds) {
  listener_.before_solving();
  original_->prepareSolve(bodies, manifolds);
}

void SolverTap::allSolved(const btContactSolverInfo& info, btIDebugDraw* drawer) {
  original_->allSolved(info, drawer);
  listener_.all_solved(info.m_timeStep);
}

}  // namespace softpoint::inline SOFTPOINT_ABI
