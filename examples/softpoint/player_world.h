#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <memory>

#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// One of Bullet's five stock worlds with all it stands on.
class StockWorld {
 public:
  explicit StockWorld(const WorldSpec& spec);
  ~StockWorld();
  StockWorld(const StockWorld&) = delete;
  StockWorld& operator=(const StockWorld&) = delete;

  btDiscreteDynamicsWorld& operator*() { return *world_; }
  btDiscreteDynamicsWorld* operator->() { return world_.get(); }

 private:
  // Destroyed from the last to the first.
  std::unique_ptr<btCollisionConfiguration> configuration_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::unique_ptr<btSoftBodySolver> soft_solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
