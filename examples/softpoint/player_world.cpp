#include "player_world.h"

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "bullet_border.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

// Unless told otherwise Bullet finds one point a frame between a plane and a box, which then sinks in.
template <class Configuration>
std::unique_ptr<Configuration> make_configuration() {
  auto configuration = std::make_unique<Configuration>();
  configuration->setPlaneConvexMultipointIterations(4, 4);
  return configuration;
}

}  // namespace

StockWorld::StockWorld(const WorldSpec& spec) {
  const bool knows_soft = spec.kind != WorldKind::kDiscrete && spec.kind != WorldKind::kMultiBody;
  if (knows_soft) {
    configuration_ = make_configuration<btSoftBodyRigidBodyCollisionConfiguration>();
  } else {
    configuration_ = make_configuration<btDefaultCollisionConfiguration>();
  }
  dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
  broadphase_ = std::make_unique<btDbvtBroadphase>();
  switch (spec.kind) {
    case WorldKind::kDiscrete:
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
      world_ = std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), broadphase_.get(), solver_.get(),
                                                         configuration_.get());
      break;
    case WorldKind::kMultiBody: {
      auto solver = std::make_unique<btMultiBodyConstraintSolver>();
      world_ = std::make_unique<btMultiBodyDynamicsWorld>(dispatcher_.get(), broadphase_.get(), solver.get(),
                                                          configuration_.get());
      solver_ = std::move(solver);
      break;
    }
    case WorldKind::kSoftRigid:
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
      world_ = std::make_unique<btSoftRigidDynamicsWorld>(dispatcher_.get(), broadphase_.get(), solver_.get(),
                                                          configuration_.get());
      break;
    case WorldKind::kSoftMultiBody: {
      auto solver = std::make_unique<btMultiBodyConstraintSolver>();
      world_ = std::make_unique<btSoftMultiBodyDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                              solver.get(), configuration_.get());
      solver_ = std::move(solver);
      break;
    }
    case WorldKind::kDeformable: {
      auto soft_solver = std::make_unique<btDeformableBodySolver>();
      auto solver = std::make_unique<btDeformableMultiBodyConstraintSolver>();
      solver->setDeformableSolver(soft_solver.get());
      world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(
          dispatcher_.get(), broadphase_.get(), solver.get(), configuration_.get(), soft_solver.get());
      solver_ = std::move(solver);
      soft_solver_ = std::move(soft_solver);
      break;
    }
  }
  world_->setGravity(to_bullet(spec.gravity));
  world_->getSolverInfo().m_numIterations = spec.solver_iterations;
}

StockWorld::~StockWorld() = default;

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
