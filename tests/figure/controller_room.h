#pragma once

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <memory>

#include "softpoint/figure/articulated_controller.h"

// A Bullet world with boxes in it, and a doll for it.
namespace softpoint::figure {

struct Room {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btBoxShape>> shapes;
  std::vector<std::unique_ptr<btRigidBody>> boxes;

  ~Room() {
    for (auto& box : boxes) world.removeRigidBody(box.get());
  }
  btRigidBody& box(const btVector3& half, double mass, const btVector3& at) {
    shapes.push_back(std::make_unique<btBoxShape>(half));
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shapes.back()->calculateLocalInertia(static_cast<btScalar>(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, shapes.back().get(),
                                                  inertia);
    info.m_startWorldTransform.setIdentity();
    info.m_startWorldTransform.setOrigin(at);
    boxes.push_back(std::make_unique<btRigidBody>(info));
    boxes.back()->setDamping(0, 0);
    world.addRigidBody(boxes.back().get());
    return *boxes.back();
  }
};

inline Vec3 vec(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

// A trunk with two arms of two links, floating.
inline FigureModel doll() {
  std::vector<Link> links(5);
  for (int i = 0; i < 5; ++i) {
    Link& link = links[static_cast<std::size_t>(i)];
    link.name = "link" + std::to_string(i);
    link.parent = i == 0 ? -1 : i == 1 || i == 3 ? 0 : i - 1;
    link.joint = i == 0 ? JointKind::kFree : i == 1 || i == 3 ? JointKind::kBall : JointKind::kHinge;
    link.axis = Vec3::UnitX();
    set_cylinder(link, i == 0 ? 8 : 2, i == 0 ? 0.1 : 0.05, 0.4);
    if (i == 1) link.origin = {0.2, 0, 0.4};
    if (i == 3) link.origin = {-0.2, 0, 0.4};
    if (i == 2 || i == 4) {
      link.origin = {0, 0, 0.4};
      link.lower = -2;
      link.upper = 2;
    }
  }
  return FigureModel(links);
}

inline FigureClip doll_clip() {
  FigureClip clip;
  clip.end = 10;
  for (int i = 0; i < 5; ++i) {
    clip.capsules.push_back({i, {0, 0, 0.06}, {0, 0, 0.34}, i == 0 ? 0.1 : 0.05});
  }
  clip.tracks = {
      {0, Interpolation::kCubic, {{0, {0, 0, 1, 1, 0, 0, 0}, {}}}},
      {2, Interpolation::kSmooth, {{0, {0.2}, {}}, {0.5, {0.9}, {}}, {1.5, {-0.4}, {}}, {3, {0.6}, {}}}}};
  return clip;
}

inline AnimationSettings weightless() {
  AnimationSettings settings;
  settings.gravity = Vec3::Zero();
  return settings;
}

}  // namespace softpoint::figure
