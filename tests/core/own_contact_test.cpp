// Deformables that solve their own contact: what core shows them and what it does with their pushes.
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <gtest/gtest.h>

#include "softpoint/core/deformable_system.h"
#include "support/multibodies.h"
#include "support/pebbles.h"
#include "support/precision.h"
#include "support/refusal.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

constexpr double kRounding = sizeof(btScalar) == 8 ? 1e-12 : 1e-5;

Vec3 momentum_of(const btRigidBody& body) {
  return to_vec(body.getLinearVelocity()) / double(body.getInvMass());
}

Vec3 spin_about_origin(const btRigidBody& body) {
  const Vec3 v = to_vec(body.getLinearVelocity()), x = to_vec(body.getWorldTransform().getOrigin());
  const btVector3 w = body.getAngularVelocity();
  return x.cross(v) / double(body.getInvMass()) + to_vec(body.getInvInertiaTensorWorld().inverse() * w);
}

TEST(OwnContact, ABlowOnAFreeBoxKeepsMomentumAndSpin) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  Pebbles pebbles = Pebbles::square(Vec3(0.05, 0.5, 0.02), 5, 0.2, 0.01);
  btRigidBody& box = world.add_box(Vec3(0.2, 0.1, 0.2), 0.5, Vec3::Zero());
  system.add(pebbles);
  pebbles.set_velocity(Vec3(0.3, -4, 0.1));
  const Vec3 before = pebbles.momentum() + momentum_of(box);
  const Vec3 spin = pebbles.angular_momentum() + spin_about_origin(box);
  double fastest = 0;
  for (int i = 0; i < 30; ++i) {
    world.step();
    EXPECT_LT((pebbles.momentum() + momentum_of(box) - before).norm(), kRounding * before.norm()) << i;
    fastest = std::max(fastest, box.getLinearVelocity().length() * 1.0);
  }
  // Spin about the origin keeps to the part of a step: impulses act where the points are.
  EXPECT_LT((pebbles.angular_momentum() + spin_about_origin(box) - spin).norm(), 0.02 * spin.norm());
  EXPECT_GT(fastest, 0.5);  // it was hit
}

TEST(OwnContact, TheWeightGoesThroughABoxToTheFloor) {
  TestWorld world;
  DeformableSystem system(*world);
  world.add_floor();
  btRigidBody& box = world.add_box(Vec3(0.2, 0.1, 0.2), 0.05, Vec3(0, 0.1, 0));
  Pebbles pebbles = Pebbles::square(Vec3(0, 0.21, 0), 5, 0.2, 0.01);
  system.add(pebbles);
  world.step(120);
  const double height = box.getWorldTransform().getOrigin().y();
  EXPECT_NEAR(height, 0.1, 1e-3);
  for (int i = 0; i < 60; ++i) {
    world.step();
    EXPECT_NEAR(box.getWorldTransform().getOrigin().y(), height, 2e-4);
  }
  Vec3 force = Vec3::Zero();
  for (const ContactPoint& point : system.contacts()) {
    EXPECT_EQ(point.other, &box);
    force += point.force;
  }
  EXPECT_NEAR(force.y(), 0.25 * 9.81, 0.02);
  for (const Vec3& p : pebbles.points()) {
    EXPECT_NEAR(p.y(), height + 0.1, 1e-3);
  }
}

// Where the collider ends up is where the points were told it would be.
TEST(OwnContact, ABoxMovesAsItsPointsSawIt) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  btRigidBody& box = world.add_box(Vec3(0.2, 0.1, 0.2), 0.05, Vec3::Zero());
  Pebbles pebbles = Pebbles::square(Vec3(0, 0.11, 0), 5, 0.2, 0.01);
  system.add(pebbles);
  pebbles.set_velocity(Vec3(0, -3, 0));
  for (int i = 0; i < 20; ++i) {
    world.step();
    const double top = box.getWorldTransform().getOrigin().y() + 0.1;
    for (const Vec3& p : pebbles.points()) {
      EXPECT_GT(p.y(), top - 1e-5) << i;
    }
  }
}

TEST(OwnContact, AKinematicLiftCarries) {
  TestWorld world;
  DeformableSystem system(*world);
  btRigidBody& lift = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  lift.setCollisionFlags(lift.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  Pebbles pebbles = Pebbles::square(Vec3(0, 0.001, 0), 4, 0.2, 0.01);
  system.add(pebbles);
  for (int i = 1; i <= 60; ++i) {
    btTransform pose = lift.getWorldTransform();
    pose.setOrigin(btVector3(0, btScalar(-0.1 + 0.01 * i), 0));
    lift.setWorldTransform(pose);
    world.step();
    for (const Vec3& p : pebbles.points()) {
      EXPECT_GT(p.y(), 0.01 * i - 1e-5);
    }
  }
}

TEST(OwnContact, ShowsEveryShape) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  auto* triangles = new btTriangleMesh;
  triangles->addTriangle(btVector3(-1, 0, -1), btVector3(-1, 0, 1), btVector3(1, 0, 1));
  triangles->addTriangle(btVector3(-1, 0, -1), btVector3(1, 0, 1), btVector3(1, 0, -1));
  auto* hull = new btConvexHullShape;
  for (int i = 0; i < 8; ++i) {
    hull->addPoint(btVector3(i & 1 ? .1f : -.1f, i & 2 ? .1f : -.1f, i & 4 ? .1f : -.1f));
  }
  auto* compound = new btCompoundShape;
  btTransform left = btTransform::getIdentity(), right = left;
  left.setOrigin(btVector3(btScalar(-0.1), 0, 0));
  right.setOrigin(btVector3(btScalar(0.1), 0, 0));
  compound->addChildShape(left, &world.keep(new btSphereShape(btScalar(0.1))));
  compound->addChildShape(right, &world.keep(new btSphereShape(btScalar(0.1))));
  struct Case {
    const char* name;
    btCollisionShape* shape;
    double top;  // m, of the shape over its origin, where the points come down
    int pieces;
  };
  const Case cases[] = {{"plane", new btStaticPlaneShape(btVector3(0, 1, 0), 0), 0.0, 1},
                        {"box", new btBoxShape(btVector3(1, btScalar(0.1), 1)), 0.1, 1},
                        {"sphere", new btSphereShape(btScalar(0.3)), 0.3, 1},
                        {"capsule", new btCapsuleShape(btScalar(0.1), btScalar(0.2)), 0.2, 1},
                        {"cylinder", new btCylinderShape(btVector3(1, btScalar(0.1), 1)), 0.1, 1},
                        {"cone", new btConeShape(btScalar(1), btScalar(0.2)), 0.1, 1},
                        {"hull", hull, 0.1, 1},
                        {"mesh", new btBvhTriangleMeshShape(triangles, true), 0.0, 1},
                        {"compound", compound, 0.1, 2}};
  for (const Case& c : cases) {
    const bool cone = c.shape->getShapeType() == CONE_SHAPE_PROXYTYPE;  // on its tip: nothing rests on that
    btRigidBody& body = world.add(c.shape, 0, Vec3::Zero(),
                                  cone ? btQuaternion(btScalar(1), 0, 0, 0) : btQuaternion::getIdentity());
    // A tiny patch over the top: one point of it comes to lie there. Over the compound: on its right half.
    const double x = c.pieces == 2 ? 0.1 : 0.0;
    Pebbles pebbles = Pebbles::square(Vec3(x, c.top + 0.02, 0), 3, 1e-4, 0.01);
    system.add(pebbles);
    pebbles.set_velocity(Vec3(0, -2, 0));
    world.step(10);
    EXPECT_EQ(pebbles.pieces, c.pieces) << c.name;
    EXPECT_NEAR(pebbles.points()[4].y(), c.top, 1e-4) << c.name;
    system.remove(pebbles);
    world.erase(body);
  }
  delete triangles;
}

TEST(OwnContact, HandlesAndAnchorsAreForwarded) {
  TestWorld world;
  DeformableSystem system(*world);
  Pebbles pebbles = Pebbles::square(Vec3(0, 1, 0), 3, 0.2, 0.01);
  system.add(pebbles);
  const HandleId hand = system.grab(pebbles, 4, Vec3(0, 1, 0));
  const HandleId weak = system.grab(pebbles, 0, Vec3(-0.1, 1, 0.1), 0.01);
  world.step(30);
  EXPECT_NEAR(system.handle_force(hand).y(), 0.01 * 9.81, 1e-6);
  EXPECT_NEAR(system.handle_force(weak).norm(), 0.01, 1e-6);
  EXPECT_NEAR(pebbles.points()[4].y(), 1.0, 1e-6);
  system.move(hand, Vec3(0.3, 1.2, 0));
  world.step();
  EXPECT_LT((pebbles.points()[4] - Vec3(0.3, 1.2, 0)).norm(), 1e-6);
  EXPECT_EQ(system.profile().counts.iterations, 0);  // none of it for core's own solver

  btRigidBody& weight = world.add_box(Vec3(0.05, 0.05, 0.05), 0.02, Vec3(0.3, 1.2, 0));
  const HandleId tie = system.attach(pebbles, 4, weight);
  world.step(30);
  EXPECT_NEAR(system.handle_force(tie).y(), -0.02 * 9.81, 2e-3);
  EXPECT_NEAR(system.handle_force(hand).y(), 0.03 * 9.81, 2e-3);
  system.release(tie);
  world.erase(weight);
  world.step(5);
  EXPECT_TRUE(system.holds(hand));
}

TEST(OwnContact, SleepsAndWakesWhenItsFloorGoes) {
  TestWorld world;
  DeformableSystem system(*world);
  btRigidBody& table = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  Pebbles pebbles = Pebbles::square(Vec3(0, 0.001, 0), 4, 0.2, 0.01);
  system.add(pebbles);
  for (int i = 0; i < 300 && !pebbles.asleep(); ++i) {
    world.step();
  }
  ASSERT_TRUE(pebbles.asleep());
  const long long steps = pebbles.steps;
  world.step(10);
  EXPECT_EQ(pebbles.steps, steps);
  EXPECT_FALSE(system.contacts().empty());
  world.erase(table);
  world.step(30);
  EXPECT_FALSE(pebbles.asleep());
  EXPECT_LT(pebbles.points()[0].y(), -0.5);
}

TEST(OwnContact, ASnapshotGoesOnWithTheSameBits) {
  TestWorld world;
  DeformableSystem system(*world);
  world.add_floor();
  world.add_box(Vec3(0.2, 0.1, 0.2), 0.2, Vec3(0, 0.1, 0));
  Pebbles pebbles = Pebbles::square(Vec3(0, 0.21, 0), 5, 0.2, 0.01);
  system.add(pebbles);
  world.step(40);
  const auto run = [&] {
    std::vector<Vec3> all;
    for (int i = 0; i < 50; ++i) {
      world.step();
      all.insert(all.end(), pebbles.points().begin(), pebbles.points().end());
    }
    return all;
  };
  const Snapshot snapshot = system.save(SnapshotScope::world);
  system.flush_contact_caches();
  const std::vector<Vec3> first = run();
  system.restore(snapshot);
  EXPECT_EQ(run(), first);
}

TEST(OwnContact, LinksOfAMultibodyFeelThePush) {
  TestWorld world(WorldKind::multibody);
  world->setGravity(btVector3(0, 0, 0));
  auto& multi = static_cast<btMultiBodyDynamicsWorld&>(*world);
  btMultiBody base(0, btScalar(0.5), btVector3(btScalar(0.005), btScalar(0.005), btScalar(0.005)), false,
                   false);
  base.setLinearDamping(0);
  base.setAngularDamping(0);
  base.finalizeMultiDof();
  btBoxShape shape(btVector3(btScalar(0.2), btScalar(0.1), btScalar(0.2)));
  btMultiBodyLinkCollider collider(&base, -1);
  collider.setCollisionShape(&shape);
  base.setBaseCollider(&collider);
  multi.addMultiBody(&base);
  multi.addCollisionObject(&collider);
  {
    DeformableSystem system(*world);
    Pebbles pebbles = Pebbles::square(Vec3(0, 0.2, 0), 5, 0.2, 0.01);
    system.add(pebbles);
    pebbles.set_velocity(Vec3(0, -3, 0));
    const Vec3 before = pebbles.momentum();
    world.step(20);
    const Vec3 after = pebbles.momentum() + 0.5 * to_vec(base.getBaseVel());
    EXPECT_LT((after - before).norm(), kRounding * before.norm());
    EXPECT_LT(base.getBaseVel().y(), -0.1);
  }
  multi.removeCollisionObject(&collider);
  multi.removeMultiBody(&base);
}

}  // namespace
}  // namespace softpoint
