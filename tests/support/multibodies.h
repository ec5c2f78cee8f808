#pragma once

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <memory>
#include <vector>

#include "support/worlds.h"

namespace softpoint {

// A row of equal boxes or balls along x, joined one to the next.
struct ChainSettings {
  int links = 2;
  bool fixed_base = true;
  Vec3 base = Vec3::Zero();          // m, centre of the base
  Vec3 half = Vec3(0.2, 0.05, 0.2);  // m, of base and links
  bool balls = false;                // of radius half.x()
  double mass = 5.0;                 // kg, of base and links each
  enum class Joint { hinge, slider, ball, planar, fixed } joint = Joint::hinge;
  Vec3 axis = Vec3::UnitZ();  // of hinges (through the middle of the gap), sliders and planes
  double gap = 0.02;          // m between two boxes
};

// Multibodies of a TestWorld, with their colliders. Destroy it before the world. No damping, no sleeping.
class Multibodies {
 public:
  explicit Multibodies(TestWorld& world)
      : shapes_(world), world_(static_cast<btMultiBodyDynamicsWorld&>(*world)) {}
  ~Multibodies() {
    for (auto& body : bodies_) {
      world_.removeMultiBody(body.get());
    }
    for (auto& collider : colliders_) {
      world_.removeCollisionObject(collider.get());
    }
  }
  Multibodies(const Multibodies&) = delete;
  Multibodies& operator=(const Multibodies&) = delete;

  btMultiBody& add_chain(const ChainSettings& s) {
    btVector3 inertia;
    shape_of(s)->calculateLocalInertia(btScalar(s.mass), inertia);
    bodies_.push_back(std::make_unique<btMultiBody>(s.links, btScalar(s.mass), inertia, s.fixed_base, false));
    btMultiBody& body = *bodies_.back();
    const btVector3 to_pivot(btScalar(s.half.x() + 0.5 * s.gap), 0, 0);
    const btQuaternion straight(0, 0, 0, 1);
    for (int i = 0; i < s.links; ++i) {
      const btScalar mass = btScalar(s.mass);
      switch (s.joint) {
        case ChainSettings::Joint::hinge:
          body.setupRevolute(i, mass, inertia, i - 1, straight, to_bt(s.axis), to_pivot, to_pivot, true);
          break;
        case ChainSettings::Joint::slider:
          body.setupPrismatic(i, mass, inertia, i - 1, straight, to_bt(s.axis), to_pivot, to_pivot, true);
          break;
        case ChainSettings::Joint::ball:
          body.setupSpherical(i, mass, inertia, i - 1, straight, to_pivot, to_pivot, true);
          break;
        case ChainSettings::Joint::planar:
          body.setupPlanar(i, mass, inertia, i - 1, straight, to_bt(s.axis), 2 * to_pivot, true);
          break;
        case ChainSettings::Joint::fixed:
          body.setupFixed(i, mass, inertia, i - 1, straight, to_pivot, to_pivot);
          break;
      }
    }
    body.finalizeMultiDof();
    body.clearVelocities();
    body.setBasePos(to_bt(s.base));
    body.setLinearDamping(0);
    body.setAngularDamping(0);
    body.setHasSelfCollision(false);
    world_.addMultiBody(&body);
    for (int i = -1; i < s.links; ++i) {
      colliders_.push_back(std::make_unique<btMultiBodyLinkCollider>(&body, i));
      btMultiBodyLinkCollider& collider = *colliders_.back();
      collider.setCollisionShape(&shapes_.keep(shape_of(s).release()));
      collider.setFriction(btScalar(0.5));
      collider.setActivationState(DISABLE_DEACTIVATION);
      (i < 0 ? body.setBaseCollider(&collider) : void(body.getLink(i).m_collider = &collider));
      const bool immovable = i < 0 && s.fixed_base;
      if (immovable) {
        collider.setCollisionFlags(collider.getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT);
      }
      world_.addCollisionObject(
          &collider, immovable ? btBroadphaseProxy::StaticFilter : btBroadphaseProxy::DefaultFilter,
          immovable ? btBroadphaseProxy::AllFilter ^ btBroadphaseProxy::StaticFilter
                    : btBroadphaseProxy::AllFilter);
    }
    place(body);
    return body;
  }

  // Colliders to where the joints say.
  static void place(btMultiBody& body) {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    body.forwardKinematics(rotations, origins);
    body.updateCollisionObjectWorldTransforms(rotations, origins);
  }

  btMultiBodyDynamicsWorld& world() { return world_; }

 private:
  static std::unique_ptr<btCollisionShape> shape_of(const ChainSettings& s) {
    if (s.balls) return std::make_unique<btSphereShape>(btScalar(s.half.x()));
    return std::make_unique<btBoxShape>(to_bt(s.half));
  }

  TestWorld& shapes_;
  btMultiBodyDynamicsWorld& world_;
  std::vector<std::unique_ptr<btMultiBody>> bodies_;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders_;
};

// Pose and velocities of a multibody, to be compared or given to a twin.
struct MultibodyState {
  btTransform base;
  std::vector<btScalar> positions;   // 7 a link
  std::vector<btScalar> velocities;  // base angular, base linear, joints

  static MultibodyState of(const btMultiBody& body) {
    MultibodyState s;
    s.base = body.getBaseWorldTransform();
    s.velocities.assign(body.getVelocityVector(), body.getVelocityVector() + 6 + body.getNumDofs());
    for (int i = 0; i < body.getNumLinks(); ++i) {
      const btScalar* q = body.getJointPosMultiDof(i);
      s.positions.insert(s.positions.end(), q, q + 7);
    }
    return s;
  }
  void put_positions(btMultiBody& body) const {
    body.setBaseWorldTransform(base);
    for (int i = 0; i < body.getNumLinks(); ++i) {
      body.setJointPosMultiDof(i, positions.data() + 7 * static_cast<std::size_t>(i));
    }
    Multibodies::place(body);
  }
  void put_velocities(btMultiBody& body) const {
    const btScalar* v = velocities.data();
    body.setBaseOmega(btVector3(v[0], v[1], v[2]));
    body.setBaseVel(btVector3(v[3], v[4], v[5]));
    for (int i = 0; i < body.getNumLinks(); ++i) {
      body.setJointVelMultiDof(i, v + 6 + body.getLink(i).m_dofOffset);
    }
  }
};

// Linear and angular momentum (about the world's origin) of a multibody, by Bullet's own kinematics.
struct MultibodyMomentum {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();

  static MultibodyMomentum of(const btMultiBody& body) {
    std::vector<btVector3> turn(static_cast<std::size_t>(body.getNumLinks()) + 1), move(turn);
    body.compTreeLinkVelocities(turn.data(), move.data());  // in the frames of the links
    MultibodyMomentum sum;
    for (int i = -1; i < body.getNumLinks(); ++i) {
      const auto k = static_cast<std::size_t>(i + 1);
      const double mass = i < 0 ? body.getBaseMass() : body.getLinkMass(i);
      const btVector3 inertia = i < 0 ? body.getBaseInertia() : body.getLinkInertia(i);
      const Vec3 p = mass * to_vec(body.localDirToWorld(i, move[k]));
      sum.linear += p;
      sum.angular += to_vec(body.localPosToWorld(i, btVector3(0, 0, 0))).cross(p) +
                     to_vec(body.localDirToWorld(i, inertia * turn[k]));
    }
    return sum;
  }
};

}  // namespace softpoint
