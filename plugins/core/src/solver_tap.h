#pragma once

#include <BulletDynamics/ConstraintSolver/btConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Told when Bullet is about to solve velocities (not in a btDeformableMultiBodyDynamicsWorld), and when it
// has solved them but not yet integrated positions.
class SolvedListener {
 public:
  virtual ~SolvedListener() = default;
  virtual void before_solving() = 0;
  virtual void all_solved(double dt) = 0;
};

// Stands before the world's own constraint solver, of whatever kind, and passes everything on.
class SolverTap final : public btConstraintSolver {
 public:
  SolverTap(btDiscreteDynamicsWorld& world, SolvedListener& listener);
  ~SolverTap() override;
  SolverTap(const SolverTap&) = delete;
  SolverTap& operator=(const SolverTap&) = delete;

  void prepareSolve(int bodies, int manifolds) override;
  btScalar solveGroup(btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
                      int manifold_count, btTypedConstraint** constraints, int constraint_count,
                      const btContactSolverInfo& info, btIDebugDraw* drawer,
                      btDispatcher* dispatcher) override {
    return original_->solveGroup(bodies, body_count, manifolds, manifold_count, constraints, constraint_count,
                                 info, drawer, dispatcher);
  }
  void allSolved(const btContactSolverInfo& info, btIDebugDraw* drawer) override;
  void reset() override { original_->reset(); }
  // Never BT_MULTIBODY_SOLVER: a multibody world would cast the tap to its own solver class. Such a world
  // keeps calling its multibody solver directly and uses this pointer only for allSolved.
  btConstraintSolverType getSolverType() const override { return BT_SEQUENTIAL_IMPULSE_SOLVER; }

 private:
  btDiscreteDynamicsWorld& world_;
  SolvedListener& listener_;
  btConstraintSolver* original_;
  bool world_owned_it_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
