// Bullet's btSoftBody as a bar: links along the edges of the surface mesh and across two of them, volume
// conservation, pose matching. It has no modulus, so ends are held and no forces are told.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include "benchmarks/bar_task.h"

namespace softpoint::benchmarks {
namespace {

struct SpringSettings {
  int iterations;  // of the position solver
  double pose;     // kMT: pull towards the rest shape, turned as a whole
  double volume;   // kVC
  bool bending;    // links between vertices two edges apart
};

class SpringBar : public Bar {
 public:
  SpringBar(const BarTask& task, const SpringSettings& settings)
      : task_(task), settings_(settings), mesh_(reference::bar_mesh(task.parts)) {
    world_.setGravity(btVector3(0, 0, 0));
    world_.getWorldInfo().m_gravity.setZero();
    world_.getWorldInfo().air_density = 0;
    std::vector<btVector3> x;
    for (const Vec3& p : mesh_.vertices) x.emplace_back(btScalar(p.x()), btScalar(p.y()), btScalar(p.z()));
    body_ = new btSoftBody(&world_.getWorldInfo(), static_cast<int>(x.size()), x.data(), nullptr);
    for (const auto& [a, b] : unique_edges(mesh_)) body_->appendLink(a, b);
    for (const Triangle& t : mesh_.triangles) body_->appendFace(t[0], t[1], t[2]);
    if (settings.bending) body_->generateBendingConstraints(2);
    body_->setTotalMass(btScalar(1000.0 * signed_volume(mesh_)));
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (std::abs(std::abs(mesh_.vertices[v].z()) - 0.5 * task.length()) > 1e-9) continue;
      body_->setMass(v, 0);
      if (mesh_.vertices[v].z() > 0) top_.push_back(v);
    }
    body_->m_materials[0]->m_kLST = 1;
    body_->m_cfg.piterations = settings.iterations;
    body_->m_cfg.collisions = 0;
    body_->m_cfg.kDP = btScalar(0.05);
    body_->m_cfg.kMT = btScalar(settings.pose);
    body_->m_cfg.kVC = btScalar(settings.volume);
    if (settings.pose > 0 || settings.volume > 0) body_->setPose(settings.volume > 0, settings.pose > 0);
    world_.addSoftBody(body_);
    body_->setActivationState(DISABLE_DEACTIVATION);
  }

  ~SpringBar() override {
    world_.removeSoftBody(body_);
    delete body_;
  }

  void frame(double load) override {
    const EndPose pose = task_.pose(load);
    const Mat3 turn = pose.rotation();
    const Vec3 centre(0.0, 0.0, 0.5 * task_.length());
    for (int v : top_) {
      const Vec3 x = centre + pose.shift + turn * (mesh_.vertices[v] - centre);
      btSoftBody::Node& node = body_->m_nodes[v];
      node.m_x = node.m_q = btVector3(btScalar(x.x()), btScalar(x.y()), btScalar(x.z()));
      node.m_v.setZero();
    }
    world_.stepSimulation(btScalar(kFrame), 1, btScalar(kFrame));
  }

  std::vector<Vec3> vertices() const override {
    std::vector<Vec3> result;
    for (int v = 0; v < body_->m_nodes.size(); ++v) {
      const btVector3& x = body_->m_nodes[v].m_x;
      result.emplace_back(x.x(), x.y(), x.z());
    }
    return result;
  }

  bool has_inertia() const override { return true; }
  double iterations() const override { return settings_.iterations; }

 private:
  BarTask task_;
  SpringSettings settings_;
  TriangleMesh mesh_;
  std::vector<int> top_;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btSoftRigidDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  btSoftBody* body_ = nullptr;
};

}  // namespace

std::vector<Contestant> spring_contestants() {
  std::vector<Contestant> result;
  const auto add = [&](const char* kind, const SpringSettings& settings) {
    result.push_back({"btSoftBody", std::string(kind) + std::to_string(settings.iterations) + " iterations",
                      [settings](const BarTask& task) -> std::unique_ptr<Bar> {
                        if (!task.is_held()) return nullptr;
                        return std::make_unique<SpringBar>(task, settings);
                      }});
  };
  for (int n : {4, 20, 100}) add("edges, ", {n, 0.0, 0.0, false});
  for (int n : {4, 20, 100, 500}) add("edges and bending links, volume, ", {n, 0.0, 0.5, true});
  for (int n : {20, 100}) add("pose matching, ", {n, 0.05, 0.0, true});
  return result;
}

}  // namespace softpoint::benchmarks
