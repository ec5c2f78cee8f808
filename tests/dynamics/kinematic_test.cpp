// Colliders that the application moves: what rests on them goes with them, what is in their way is swept.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/multibodies.h"
#include "support/penetration.h"
#include "support/precision.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

enum class Carrier { rigid, object, multibody };

// A kinematic collider of one of three kinds, moved before every step.
class Moved {
 public:
  Moved(TestWorld& world, Carrier kind, btCollisionShape& shape, const btTransform& start)
      : world_(world), kind_(kind) {
    if (kind == Carrier::multibody) {
      multibody_ = std::make_unique<btMultiBody>(0, btScalar(1), btVector3(1, 1, 1), false, false);
      multibody_->finalizeMultiDof();
      multibody_->clearVelocities();
      auto link = std::make_unique<btMultiBodyLinkCollider>(multibody_.get(), -1);
      multibody_->setBaseCollider(link.get());
      object_ = std::move(link);
      static_cast<btMultiBodyDynamicsWorld&>(*world).addMultiBody(multibody_.get());
    } else if (kind == Carrier::rigid) {
      object_ = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
    } else {
      object_ = std::make_unique<btCollisionObject>();
    }
    object_->setCollisionShape(&shape);
    object_->setFriction(btScalar(0.8));
    object_->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    object_->setActivationState(DISABLE_DEACTIVATION);
    object_->setWorldTransform(start);
    object_->setInterpolationWorldTransform(start);
    put(start);
    if (kind == Carrier::rigid) {
      world->addRigidBody(static_cast<btRigidBody*>(object_.get()));
    } else {
      world->addCollisionObject(object_.get(), btBroadphaseProxy::KinematicFilter,
                                btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter);
    }
  }
  ~Moved() {
    if (kind_ == Carrier::rigid) {
      world_->removeRigidBody(static_cast<btRigidBody*>(object_.get()));
    } else {
      world_->removeCollisionObject(object_.get());
    }
    if (multibody_) static_cast<btMultiBodyDynamicsWorld&>(*world_).removeMultiBody(multibody_.get());
  }
  Moved(const Moved&) = delete;
  Moved& operator=(const Moved&) = delete;

  void move_to(const btTransform& pose, const Vec3& velocity, const Vec3& angular) {
    put(pose);
    if (multibody_) {
      multibody_->setBaseVel(to_bt(velocity));
      multibody_->setBaseOmega(to_bt(angular));
    }
    if (kind_ == Carrier::object) {
      object_->setInterpolationLinearVelocity(to_bt(velocity));
      object_->setInterpolationAngularVelocity(to_bt(angular));
    }
  }
  const btCollisionObject& object() const { return *object_; }

 private:
  void put(const btTransform& pose) {
    object_->setWorldTransform(pose);
    if (multibody_) multibody_->setBaseWorldTransform(pose);
  }
  TestWorld& world_;
  Carrier kind_;
  std::unique_ptr<btMultiBody> multibody_;
  std::unique_ptr<btCollisionObject> object_;
};

const std::vector<std::pair<WorldKind, Carrier>> kCarriers = {{WorldKind::discrete, Carrier::rigid},
                                                              {WorldKind::discrete, Carrier::object},
                                                              {WorldKind::soft_multibody, Carrier::rigid},
                                                              {WorldKind::multibody, Carrier::multibody},
                                                              {WorldKind::deformable, Carrier::multibody}};

class Kinematic : public ::testing::TestWithParam<std::pair<WorldKind, Carrier>> {};
INSTANTIATE_TEST_SUITE_P(Carriers, Kinematic, ::testing::ValuesIn(kCarriers));

TEST_P(Kinematic, TurningDrumsCarryABarAtTheirSurfaceSpeed) {
  const auto [world_kind, carrier] = GetParam();
  for (const double speed : {0.1, 0.5}) {  // m/s
    TestWorld world(world_kind);
    const double radius = 0.2;
    btCollisionShape& shape = world.keep(new btCapsuleShapeZ(btScalar(radius), btScalar(0.6)));
    std::vector<std::unique_ptr<Moved>> drums;
    for (int i = -3; i <= 4; ++i) {
      drums.push_back(std::make_unique<Moved>(
          world, carrier, shape,
          btTransform(btQuaternion::getIdentity(), btVector3(btScalar(0.41 * i), btScalar(-radius), 0))));
    }
    DeformableSystem system(*world);
    ElasticBody bar(model_of(Shape::bar, 1e7), Vec3(0, 0.102, 0));
    bar.setFriction(btScalar(0.8));
    system.add(bar);
    const double rate = -speed / radius;
    double mean = 0;
    for (int i = 1; i <= 90; ++i) {
      const btQuaternion turn(btVector3(0, 0, 1), btScalar(std::fmod(rate * i / 60.0, 2 * std::numbers::pi)));
      for (std::size_t d = 0; d < drums.size(); ++d) {
        drums[d]->move_to(btTransform(turn, drums[d]->object().getWorldTransform().getOrigin()), Vec3::Zero(),
                          Vec3(0, 0, rate));
      }
      world.step();
      if (i > 60) mean += bar.momentum().x() / bar.total_mass() / 30.0;
    }
    std::printf("    bar moves at %.5f of the surface speed\n", mean / speed);
    EXPECT_NEAR(mean / speed, 1.0, 0.01);
  }
}

TEST_P(Kinematic, ElevatorLiftsWithoutSinking) {
  const auto [world_kind, carrier] = GetParam();
  for (const double young : {1e5, 1e7}) {
    TestWorld world(world_kind);
    btCollisionShape& shape = world.keep(new btBoxShape(btVector3(1, btScalar(0.1), 1)));
    btTransform pose(btQuaternion::getIdentity(), btVector3(0, btScalar(-0.1), 0));
    Moved lift(world, carrier, shape, pose);
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::part, young), Vec3(0, 0.252, 0));
    system.add(body);
    double height = 0, deepest = -1;
    for (int i = 1; i <= 240; ++i) {
      const double t = i / 60.0;
      const double v = t < 3 ? 0.8 * std::sin(std::numbers::pi * t / 3) : 0.0;  // up, 0.84 m/s2 at the ends
      height += v / 60.0;
      pose.setOrigin(btVector3(0, btScalar(height - 0.1), 0));
      lift.move_to(pose, Vec3(0, v, 0), Vec3::Zero());
      world.step();
      deepest = std::max(deepest, skin_depth(body, lift.object()));
    }
    std::printf("    E %.0e: lifted %.2f m, deepest %.2e m\n", young, height, deepest);
    EXPECT_LE(deepest, 1e-3);
    EXPECT_GT(body.center_of_mass().y(), height + 0.2);
  }
}

TEST_P(Kinematic, PaddleSweepsWithoutPenetration) {
  const auto [world_kind, carrier] = GetParam();
  for (const double young : {1e5, 1e7}) {
    TestWorld world(world_kind);
    world.add_floor();
    btCollisionShape& shape = world.keep(new btBoxShape(btVector3(1, btScalar(0.5), btScalar(0.05))));
    const auto pose_at = [](double angle) {
      return btTransform(btQuaternion(btVector3(0, 1, 0), btScalar(angle)),
                         btVector3(btScalar(std::cos(angle)), btScalar(0.51), btScalar(-std::sin(angle))));
    };
    Moved paddle(world, carrier, shape, pose_at(0));
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::ball, young), Vec3(1.1, 0.302, -0.5));
    system.add(body);
    const double rate = 2.0;  // rad/s
    double deepest = -1, corner = -1;
    int touched = 0;
    for (int i = 1; i <= 90; ++i) {
      const double angle = rate * i / 60.0;
      // The velocity over the step, as Bullet finds it for a kinematic rigid body: from pose to pose.
      const Vec3 from = to_vec(pose_at(angle - rate / 60).getOrigin()),
                 to = to_vec(pose_at(angle).getOrigin());
      paddle.move_to(pose_at(angle), 60.0 * (to - from), Vec3(0, rate, 0));
      world.step();
      deepest = std::max(deepest, skin_depth(body, paddle.object()));
      corner = std::max(corner, corner_depth(body, paddle.object()));
      for (const ContactPoint& c : system.contacts()) {
        if (c.other == &paddle.object()) {
          ++touched;
          break;
        }
      }
    }
    std::printf("    E %.0e: deepest vertex %.2e m, corner %.2e m; body at %.2f %.2f, %d steps in contact\n",
                young, deepest, corner, body.center_of_mass().x(), body.center_of_mass().z(), touched);
    EXPECT_GT(touched, 10);
    EXPECT_LE(deepest, 1e-3);
    EXPECT_LE(corner, 1e-3);
    EXPECT_LT(body.center_of_mass().z(), -0.8);
  }
}

// A static object's velocities mean nothing.
TEST(StaticCollider, IsStillWhateverItsVelocities) {
  TestWorld world;
  btRigidBody& floor = world.add_box(Vec3(2, 0.5, 2), 0, Vec3(0, -0.5, 0));
  btCollisionObject plain;
  plain.setCollisionShape(&world.keep(new btBoxShape(btVector3(1, 1, 1))));
  plain.setCollisionFlags(btCollisionObject::CF_STATIC_OBJECT);
  plain.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(10, -1, 0)));
  plain.setFriction(1);
  world->addCollisionObject(&plain, btBroadphaseProxy::StaticFilter, btBroadphaseProxy::AllFilter);
  DeformableSystem system(*world);
  ElasticBody one(model_of(Shape::cube, 1e6), Vec3(0, 0.201, 0)),
      two(model_of(Shape::cube, 1e6), Vec3(10, 0.201, 0));
  system.add(one);
  system.add(two);
  for (int i = 0; i < 120; ++i) {
    floor.setLinearVelocity(btVector3(1, 0, 0));
    for (btCollisionObject* object : {static_cast<btCollisionObject*>(&floor), &plain}) {
      object->setInterpolationLinearVelocity(btVector3(1, 0, 0));
      object->setInterpolationAngularVelocity(btVector3(0, 1, 0));
    }
    world.step();
  }
  EXPECT_NEAR(one.center_of_mass().x(), 0, 1e-4);
  EXPECT_NEAR(two.center_of_mass().x(), 10, 1e-4);
  world->removeCollisionObject(&plain);
}

}  // namespace
}  // namespace softpoint
