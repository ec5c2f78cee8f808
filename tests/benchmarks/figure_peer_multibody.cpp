#include <BulletDynamics/Featherstone/btMultiBody.h>

#include <algorithm>

#include "benchmarks/figure_peers.h"

namespace softpoint::benchmarks {
namespace {

using figure::JointKind;

btVector3 bullet(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

class MultiBodyPeer : public FigurePeer {
 public:
  MultiBodyPeer(const figure::FigureModel& model, const figure::FigureState& state) {
    const auto& links = model.links();
    const bool free = links[0].joint == JointKind::kFree;
    const auto mass = [](const figure::Link& link) { return std::max(link.mass, 1e-9); };
    const auto inertia = [](const figure::Link& link) {
      return bullet(link.inertia.diagonal().cwiseMax(1e-12));
    };
    const int shift = free ? 1 : 0;  // a base of its own for figures that hang on the world
    body_ = std::make_unique<btMultiBody>(static_cast<int>(links.size()) - shift, free ? mass(links[0]) : 0.0,
                                          free ? inertia(links[0]) : btVector3(0, 0, 0), !free, false);
    for (std::size_t i = static_cast<std::size_t>(shift); i < links.size(); ++i) {
      const figure::Link& link = links[i];
      const int own = static_cast<int>(i) - shift;
      const Vec3 parent_center =
          link.parent < 0 ? Vec3(Vec3::Zero()) : links[static_cast<std::size_t>(link.parent)].center_of_mass;
      body_->setupRevolute(own, mass(link), inertia(link), link.parent - shift, btQuaternion::getIdentity(),
                           bullet(link.axis), bullet(link.origin - parent_center),
                           bullet(link.center_of_mass), true);
    }
    body_->finalizeMultiDof();
    body_->setBaseOmega({state.qd[0], free ? state.qd[1] : 0, free ? state.qd[2] : 0});
    for (std::size_t i = static_cast<std::size_t>(shift); i < links.size(); ++i) {
      const int own = static_cast<int>(i) - shift;
      body_->setJointPos(own, state.q[static_cast<std::size_t>(model.position_offset(static_cast<int>(i)))]);
      body_->setJointVel(own, state.qd[static_cast<std::size_t>(model.velocity_offset(static_cast<int>(i)))]);
      body_->addLinkForce(own, mass(links[i]) * btVector3(0, 0, -9.81));
    }
    body_->addBaseForce(body_->getBaseMass() * btVector3(0, 0, -9.81));
    dofs_ = body_->getNumDofs() + 6;
  }

  std::string name() const override { return "btMultiBody (Bullet 3.24, double)"; }
  void forward() override {  // a time step of 0 leaves the velocities alone
    body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(0, numbers_, vectors_, matrices_, false,
                                                                false, false);
  }
  double largest_acceleration() override {
    double most = 0;
    for (int k = 0; k < std::min(dofs_, numbers_.size()); ++k)
      most = std::max(most, std::abs(double(numbers_[k])));
    return most;
  }

 private:
  std::unique_ptr<btMultiBody> body_;
  btAlignedObjectArray<btScalar> numbers_;
  btAlignedObjectArray<btVector3> vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
  int dofs_ = 0;
};

}  // namespace

std::unique_ptr<FigurePeer> multibody_peer(const figure::FigureModel& model,
                                           const figure::FigureState& state) {
  return std::make_unique<MultiBodyPeer>(model, state);
}

}  // namespace softpoint::benchmarks
