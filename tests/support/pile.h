#pragma once

#include <memory>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/worlds.h"

namespace softpoint {

// Two elastic bodies on a floor, and ten rigid bodies of every shape that fall onto them; all may sleep.
class Pile {
 public:
  explicit Pile(WorldKind kind = WorldKind::discrete, double young = 1e5)
      : world(kind),
        floor(begin()),
        system(*world),
        cube(model_of(Shape::cube, young), Vec3(-0.25, 0.21, 0)),
        ball(model_of(Shape::ball, young), Vec3(0.35, 0.31, 0)) {
    system.add(cube);
    system.add(ball);
    auto* hull = new btConvexHullShape();
    for (const Vec3& p : {Vec3(0.1, 0, 0), Vec3(-0.1, 0, 0.02), Vec3(0, 0.12, 0), Vec3(0, -0.08, 0),
                          Vec3(0, 0.02, 0.1), Vec3(0.02, 0, -0.1)}) {
      hull->addPoint(to_bt(p));
    }
    auto* cross = new btCompoundShape();
    for (const Vec3& half : {Vec3(0.12, 0.03, 0.03), Vec3(0.03, 0.12, 0.03)}) {
      cross->addChildShape(btTransform::getIdentity(), &world.keep(new btBoxShape(to_bt(half))));
    }
    drop(new btBoxShape(to_bt({0.1, 0.08, 0.12})), 2, {-0.3, 0.6, 0});
    drop(new btSphereShape(btScalar(0.08)), 1, {0.3, 0.8, 0.05});
    drop(new btCapsuleShape(btScalar(0.06), btScalar(0.15)), 1, {-0.2, 0.9, 0.1});
    drop(new btCylinderShape(to_bt({0.08, 0.1, 0.08})), 1.5, {0.35, 1.0, -0.1});
    drop(new btConeShape(btScalar(0.1), btScalar(0.2)), 1, {-0.25, 1.2, -0.05});
    drop(hull, 1, {0.4, 1.25, 0.05});
    drop(cross, 1, {0, 1.4, 0});
    drop(new btBoxShape(to_bt({0.06, 0.06, 0.06})), 0.7, {-0.1, 1.6, 0.1});
    drop(new btSphereShape(btScalar(0.06)), 0.5, {-0.3, 1.7, 0});
    drop(new btCapsuleShape(btScalar(0.05), btScalar(0.2)), 0.8, {0.35, 1.6, 0});
  }

  bool all_asleep() const {
    for (const btRigidBody* body : rigid) {
      if (body->isActive()) return false;
    }
    return cube.asleep() && ball.asleep();
  }

  TestWorld world;
  btRigidBody& floor;
  DeformableSystem system;
  elastic::ElasticBody cube, ball;
  std::vector<btRigidBody*> rigid;

 private:
  btRigidBody& begin() {
    // Not a plane: small boxes that lean on others rock on Bullet's plane contacts for good.
    btRigidBody& slab = world.add_box(Vec3(5, 0.5, 5), 0, Vec3(0, -0.5, 0));
    slab.forceActivationState(ISLAND_SLEEPING);  // as in any world but the tests'
    return slab;
  }
  // Round shapes stop only by rolling and spinning friction and damping.
  void drop(btCollisionShape* shape, double mass, const Vec3& position) {
    btRigidBody& body = world.add(shape, mass, position);
    body.forceActivationState(ACTIVE_TAG);
    body.setRollingFriction(btScalar(0.02));
    body.setSpinningFriction(btScalar(0.02));
    body.setDamping(0, btScalar(0.1));
    rigid.push_back(&body);
  }
};

}  // namespace softpoint
