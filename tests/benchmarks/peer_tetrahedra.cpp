// Bullet's btDeformable tetrahedra as a bar: the same surface vertices and one more on the axis of every
// layer.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "benchmarks/bar_task.h"

namespace softpoint::benchmarks {
namespace {

struct TetrahedraSettings {
  bool neo_hookean;
  int newton, conjugate;  // most iterations
  double density;         // kg/m^3: little mass lets the bar settle soon
  int substeps;
  double damping;  // stiffness-proportional, s
};

// Bullet's own solver with its limits of iterations opened.
class OpenSolver : public btDeformableBodySolver {
 public:
  OpenSolver(int newton, int conjugate) {
    m_maxNewtonIterations = newton;
    m_cg.m_maxIterations = m_cr.m_maxIterations = conjugate;
  }
};

// A dead load on some nodes.
class DeadLoad : public btDeformableLagrangianForce {
 public:
  std::vector<std::pair<int, btVector3>> force;  // node, N
  void addScaledForces(btScalar scale, TVStack& to) override { addScaledExplicitForce(scale, to); }
  void addScaledExplicitForce(btScalar scale, TVStack& to) override {
    for (const auto& [node, f] : force) to[m_softBodies[0]->m_nodes[node].index] += scale * f;
  }
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}
  void addScaledElasticForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void addScaledDampingForce(btScalar, TVStack&) override {}
  btDeformableLagrangianForceType getForceType() override { return BT_MOUSE_PICKING_FORCE; }
};

class TetrahedraBar : public Bar {
 public:
  TetrahedraBar(const BarTask& task, const TetrahedraSettings& settings)
      : task_(task),
        settings_(settings),
        mesh_(reference::bar_mesh(task.parts)),
        solver_(settings.newton, settings.conjugate) {
    constraints_.setDeformableSolver(&solver_);
    world_.setGravity(btVector3(0, 0, 0));
    world_.getWorldInfo().m_gravity.setZero();
    world_.setImplicit(true);
    world_.setLineSearch(false);
    world_.setUseProjection(true);
    make_body();
    world_.addSoftBody(body_);
    const double mu = kYoung / (2 * (1 + kPoisson)), lambda = 2 * mu * kPoisson / (1 - 2 * kPoisson);
    if (settings.neo_hookean) {
      // Bullet's moduli of this law are not Lame's: for small strains 3/4 mu and lambda - 5/8 mu are.
      elastic_ = std::make_unique<btDeformableNeoHookeanForce>(
          btScalar(4.0 / 3.0 * mu), btScalar(lambda + 5.0 / 6.0 * mu), btScalar(settings.damping));
    } else {
      elastic_ = std::make_unique<btDeformableLinearElasticityForce>(btScalar(mu), btScalar(lambda),
                                                                     btScalar(0), btScalar(settings.damping));
    }
    world_.addForce(body_, elastic_.get());
    if (!task.is_held()) world_.addForce(body_, &load_);
  }

  ~TetrahedraBar() override {
    world_.removeSoftBody(body_);
    delete body_;
  }

  void frame(double load) override {
    const btScalar step = btScalar(kFrame / settings_.substeps);
    for (int i = 1; i <= settings_.substeps; ++i) {
      const double now = last_load_ + (load - last_load_) * i / settings_.substeps;
      if (task_.is_held()) {
        const EndPose pose = task_.pose(now);
        const Mat3 turn = pose.rotation();
        const Vec3 centre(0.0, 0.0, 0.5 * task_.length());
        for (int v : top_) {
          const Vec3 x = centre + pose.shift + turn * (mesh_.vertices[v] - centre);
          btSoftBody::Node& node = body_->m_nodes[v];
          node.m_x = node.m_q = btVector3(btScalar(x.x()), btScalar(x.y()), btScalar(x.z()));
          node.m_v.setZero();
        }
      } else {
        const Vec3 total = task_.force(now);
        for (auto& [node, f] : load_.force) {
          const Vec3 share = total * share_[node];
          f = btVector3(btScalar(share.x()), btScalar(share.y()), btScalar(share.z()));
        }
      }
      world_.stepSimulation(step, 1, step);
    }
    last_load_ = load;
  }

  std::vector<Vec3> vertices() const override {
    std::vector<Vec3> result;
    for (int v = 0; v < mesh_.vertex_count(); ++v) result.push_back(position(v));
    return result;
  }

  std::optional<Vec3> end_force() const override { return resultant().first; }
  std::optional<Vec3> end_moment() const override { return resultant().second; }
  bool has_inertia() const override { return true; }
  double iterations() const override { return settings_.newton * settings_.substeps; }

 private:
  Vec3 position(int v) const {
    const btVector3& x = body_->m_nodes[v].m_x;
    return {x.x(), x.y(), x.z()};
  }

  void make_body() {
    std::vector<btVector3> x;
    for (const Vec3& p : mesh_.vertices) x.emplace_back(btScalar(p.x()), btScalar(p.y()), btScalar(p.z()));
    const int sides = reference::kSides, layers = 4 * task_.parts;
    std::vector<int> axis = {0};
    for (int i = 1; i < layers; ++i) {
      axis.push_back(static_cast<int>(x.size()));
      x.emplace_back(btScalar(0), btScalar(0), btScalar(task_.length() * (1.0 * i / layers - 0.5)));
    }
    axis.push_back(mesh_.vertex_count() - 1);
    body_ = new btSoftBody(&world_.getWorldInfo(), static_cast<int>(x.size()), x.data(), nullptr);
    // Every sector of a layer is a wedge of three tetrahedra; the side's quads are cut as in the surface
    // mesh.
    const auto at = [&](int layer, int k) { return 1 + layer * sides + k % sides; };
    for (int layer = 0; layer < layers; ++layer) {
      for (int k = 0; k < sides; ++k) {
        const int a = axis[layer], d = axis[layer + 1];
        const int b = at(layer, k), c = at(layer, k + 1), e = at(layer + 1, k), f = at(layer + 1, k + 1);
        if ((layer + k) % 2 == 0) {  // quad b c f e cut along b f
          add(a, b, c, f), add(a, b, f, e), add(a, e, f, d);
        } else {  // along c e
          add(a, b, c, e), add(a, c, f, e), add(a, e, f, d);
        }
      }
    }
    body_->setTotalMass(1);
    body_->setVolumeDensity(btScalar(settings_.density));
    share_.assign(x.size(), 0.0);
    const double cap_edge = 2.0 / 3.0 / reference::kSides;  // of the cap's area: a third to its centre
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      const double z = mesh_.vertices[v].z();
      if (std::abs(std::abs(z) - 0.5 * task_.length()) > 1e-9) continue;
      if (z < 0 || task_.is_held()) body_->setMass(v, 0);
      if (z < 0) continue;
      top_.push_back(v);
      share_[v] = v == mesh_.vertex_count() - 1 ? 1.0 / 3.0 : cap_edge;
      load_.force.emplace_back(v, btVector3(0, 0, 0));
    }
    body_->initializeDmInverse();
    body_->m_tetraScratches.resize(body_->m_tetras.size());
    body_->m_tetraScratchesTn.resize(body_->m_tetras.size());
    body_->m_cfg.collisions = 0;
    body_->m_cfg.kDF = 0;
    body_->m_cfg.drag = 0;
    body_->setSelfCollision(false);
    body_->m_sleepingThreshold = 0;
    body_->setActivationState(DISABLE_DEACTIVATION);
  }

  void add(int a, int b, int c, int d) { body_->appendTetra(a, b, c, d); }

  // From the stress of the tetrahedra: what must hold the top cap.
  std::pair<Vec3, Vec3> resultant() const {
    auto* self = const_cast<TetrahedraBar*>(this);
    self->body_->updateDeformation();
    int count = 0;
    for (int i = 0; i < body_->m_nodes.size(); ++i) count = std::max(count, body_->m_nodes[i].index + 1);
    btAlignedObjectArray<btVector3> force;
    force.resize(count, btVector3(0, 0, 0));
    elastic_->addScaledExplicitForce(1, force);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    const Vec3 centre = position(mesh_.vertex_count() - 1);
    for (int v : top_) {
      const btVector3& f = force[body_->m_nodes[v].index];
      const Vec3 hold(-f.x(), -f.y(), -f.z());
      sum += hold;
      moment += (position(v) - centre).cross(hold);
    }
    return {sum, moment};
  }

  BarTask task_;
  TetrahedraSettings settings_;
  TriangleMesh mesh_;
  std::vector<int> top_;
  std::vector<double> share_;
  double last_load_ = 0;
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  OpenSolver solver_;
  btDeformableMultiBodyConstraintSolver constraints_;
  std::unique_ptr<btDeformableLagrangianForce> elastic_;
  DeadLoad load_;
  btDeformableMultiBodyDynamicsWorld world_{&dispatcher_, &broadphase_, &constraints_, &configuration_,
                                            &solver_};
  btSoftBody* body_ = nullptr;
};

}  // namespace

std::vector<Contestant> tetrahedra_contestants() {
  std::vector<Contestant> result;
  const auto add = [&](const TetrahedraSettings& s) {
    result.push_back({"btDeformable",
                      std::string(s.neo_hookean ? "neo-Hookean" : "corotated linear") + ", Newton " +
                          std::to_string(s.newton) + ", CG " + std::to_string(s.conjugate),
                      [s](const BarTask& task) -> std::unique_ptr<Bar> {
                        return std::make_unique<TetrahedraBar>(task, s);
                      }});
  };
  for (int cg : {10, 40, 160}) add({false, 1, cg, 1.0, 1, 0.0});
  add({false, 3, 400, 1.0, 1, 0.0});
  add({true, 1, 160, 1.0, 1, 0.0});
  return result;
}

}  // namespace softpoint::benchmarks
