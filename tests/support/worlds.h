#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "softpoint/core/vec.h"

namespace softpoint {

enum class WorldKind { discrete, multibody, soft_rigid, soft_multibody, deformable };

inline btVector3 to_bt(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }
inline Vec3 to_vec(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

// One stock world with the solver and collision configuration that belong to it, and what the tests put
// into it. `soft_configuration` gives the two plain worlds the soft-body configuration too.
class TestWorld {
 public:
  explicit TestWorld(WorldKind kind = WorldKind::discrete, bool soft_configuration = false,
                     bool own_solver = true) {
    const bool plain = kind == WorldKind::discrete || kind == WorldKind::multibody;
    if (plain && !soft_configuration) {
      configuration_ = std::make_unique<btDefaultCollisionConfiguration>();
    } else {
      configuration_ = std::make_unique<btSoftBodyRigidBodyCollisionConfiguration>();
    }
    dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
    broadphase_ = std::make_unique<btDbvtBroadphase>();
    switch (kind) {
      case WorldKind::discrete:
        if (own_solver) {
          solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
        }
        world_ = std::make_unique<btDiscreteDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                           solver_.get(), configuration_.get());
        break;
      case WorldKind::multibody: {
        auto solver = std::make_unique<btMultiBodyConstraintSolver>();
        world_ = std::make_unique<btMultiBodyDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                            solver.get(), configuration_.get());
        solver_ = std::move(solver);
        break;
      }
      case WorldKind::soft_rigid:
        if (own_solver) {
          solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
        }
        world_ = std::make_unique<btSoftRigidDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                            solver_.get(), configuration_.get());
        break;
      case WorldKind::soft_multibody: {
        auto solver = std::make_unique<btMultiBodyConstraintSolver>();
        world_ = std::make_unique<btSoftMultiBodyDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                                solver.get(), configuration_.get());
        solver_ = std::move(solver);
        break;
      }
      case WorldKind::deformable: {
        auto solver = std::make_unique<btDeformableMultiBodyConstraintSolver>();
        auto deformable = std::make_unique<btDeformableBodySolver>();
        solver->setDeformableSolver(deformable.get());
        world_ = std::make_unique<btDeformableMultiBodyDynamicsWorld>(
            dispatcher_.get(), broadphase_.get(), solver.get(), configuration_.get(), deformable.get());
        solver_ = std::move(solver);
        deformable_solver_ = std::move(deformable);
        break;
      }
    }
    world_->setGravity(btVector3(0, btScalar(-9.81), 0));
  }

  ~TestWorld() {
    for (auto& body : bodies_) {
      if (body) {
        world_->removeRigidBody(body.get());
      }
    }
  }
  TestWorld(const TestWorld&) = delete;
  TestWorld& operator=(const TestWorld&) = delete;

  btDiscreteDynamicsWorld& operator*() { return *world_; }
  btDiscreteDynamicsWorld* operator->() { return world_.get(); }
  btCollisionDispatcher& dispatcher() { return *dispatcher_; }
  btCollisionConfiguration& configuration() { return *configuration_; }
  btSoftBodyWorldInfo* soft_info() {
    if (auto* world = dynamic_cast<btSoftRigidDynamicsWorld*>(world_.get())) return &world->getWorldInfo();
    if (auto* world = dynamic_cast<btSoftMultiBodyDynamicsWorld*>(world_.get()))
      return &world->getWorldInfo();
    if (auto* world = dynamic_cast<btDeformableMultiBodyDynamicsWorld*>(world_.get())) {
      return &world->getWorldInfo();
    }
    return nullptr;
  }

  // Owned here. Mass 0 makes it static. No damping, no sleeping, friction 0.5.
  btRigidBody& add(btCollisionShape* shape, double mass, const Vec3& position,
                   const btQuaternion& rotation = btQuaternion::getIdentity()) {
    shapes_.emplace_back(shape);
    return add_shared(*shape, mass, position, rotation);
  }
  btRigidBody& add_shared(btCollisionShape& shape, double mass, const Vec3& position,
                          const btQuaternion& rotation = btQuaternion::getIdentity()) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) {
      shape.calculateLocalInertia(btScalar(mass), inertia);
    }
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform = btTransform(rotation, to_bt(position));
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies_.back();
    body.setActivationState(DISABLE_DEACTIVATION);
    body.setDamping(0, 0);
    world_->addRigidBody(&body);
    return body;
  }
  btRigidBody& add_floor(double height = 0.0) {
    return add(new btStaticPlaneShape(btVector3(0, 1, 0), btScalar(height)), 0, Vec3::Zero());
  }
  btRigidBody& add_box(const Vec3& half, double mass, const Vec3& position,
                       const btQuaternion& rotation = btQuaternion::getIdentity()) {
    return add(new btBoxShape(to_bt(half)), mass, position, rotation);
  }
  btCollisionShape& keep(btCollisionShape* shape) {
    shapes_.emplace_back(shape);
    return *shape;
  }
  // Takes it out of the world and deletes it.
  void erase(btRigidBody& body) {
    world_->removeRigidBody(&body);
    for (auto& mine : bodies_) {
      if (mine.get() == &body) {
        mine.reset();
      }
    }
  }

  // Fixed steps without interpolation.
  void step(int count = 1, double dt = 1.0 / 60.0) {
    for (int i = 0; i < count; ++i) {
      world_->stepSimulation(btScalar(dt), 0);
    }
  }

 private:
  std::unique_ptr<btCollisionConfiguration> configuration_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<btBroadphaseInterface> broadphase_;
  std::unique_ptr<btSoftBodySolver> deformable_solver_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace softpoint
