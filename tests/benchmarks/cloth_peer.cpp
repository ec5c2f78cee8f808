#include "benchmarks/cloth_peer.h"

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include "benchmarks/thread_time.h"

namespace softpoint::benchmarks {
namespace {

btVector3 to_bullet(const Vec3& v) { return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())}; }

}  // namespace

TimedRun bullet_lift(const cloth::LiftTask& task, int iterations, int substeps) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  const btVector3 gravity(0, 0, btScalar(-cloth::LiftTask::kGravity));
  world.setGravity(gravity);
  world.getWorldInfo().m_gravity = gravity;
  world.getWorldInfo().air_density = 0;
  world.getWorldInfo().m_sparsesdf.Initialize();

  btStaticPlaneShape plane(btVector3(0, 0, 1), 0);
  btRigidBody floor(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &plane));
  floor.setFriction(btScalar(cloth::LiftTask::kFriction));
  world.addRigidBody(&floor);

  const cloth::ClothPattern pattern = cloth::reference_pattern(task.columns);
  std::vector<btVector3> start;
  for (const Vec3& p : pattern.points) start.push_back(to_bullet(p + Vec3(0, 0, task.start_height())));
  btSoftBody body(&world.getWorldInfo(), static_cast<int>(start.size()), start.data(), nullptr);
  for (const cloth::Spring& s : pattern.springs) body.appendLink(s.a, s.b);
  for (const Triangle& t : pattern.faces) body.appendFace(t[0], t[1], t[2]);
  body.setTotalMass(btScalar(cloth::LiftTask::kMass));
  for (int p : task.picked) body.setMass(p, 0);
  body.m_materials[0]->m_kLST = 1;
  body.m_cfg.piterations = iterations;
  body.m_cfg.kDF = btScalar(cloth::LiftTask::kFriction);
  body.m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
  body.getCollisionShape()->setMargin(btScalar(1e-3));
  world.addSoftBody(&body);
  body.setActivationState(DISABLE_DEACTIVATION);

  TimedRun timed;
  std::vector<Vec3> x(pattern.points.size());
  const auto note = [&](double time) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const btVector3& p = body.m_nodes[static_cast<int>(i)].m_x;
      x[i] = Vec3(p.x(), p.y(), p.z());
    }
    timed.run.push_back(cloth::measure_cloth(pattern, x));
    timed.run.back().time = time;
  };
  note(0);
  const double h = cloth::LiftTask::kFrame / substeps;
  for (int k = 1; k <= task.frames(); ++k) {
    const double begin = thread_seconds();
    for (int s = 1; s <= substeps; ++s) {
      const double time = (k - 1) * cloth::LiftTask::kFrame + s * h;
      for (int p : task.picked) {
        btSoftBody::Node& node = body.m_nodes[p];
        node.m_x = node.m_q =
            start[static_cast<std::size_t>(p)] + btVector3(0, 0, btScalar(task.lifted(time)));
        node.m_v.setZero();
      }
      world.stepSimulation(btScalar(h), 1, btScalar(h));
    }
    timed.seconds.push_back(thread_seconds() - begin);
    note(k * cloth::LiftTask::kFrame);
    if (!std::isfinite(timed.run.back().top + timed.run.back().max_stretch)) break;
  }
  world.removeSoftBody(&body);
  world.removeRigidBody(&floor);
  return timed;
}

}  // namespace softpoint::benchmarks
