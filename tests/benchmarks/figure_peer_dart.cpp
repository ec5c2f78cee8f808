#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

#include <algorithm>

#include "benchmarks/figure_peers.h"

namespace softpoint::benchmarks {
namespace {

using figure::JointKind;

class DartPeer : public FigurePeer {
 public:
  DartPeer(const figure::FigureModel& model, const figure::FigureState& state)
      : skeleton_(dart::dynamics::Skeleton::create("figure")) {
    std::vector<dart::dynamics::BodyNode*> bodies;
    for (const figure::Link& link : model.links()) {
      dart::dynamics::BodyNode* parent =
          link.parent < 0 ? nullptr : bodies[static_cast<std::size_t>(link.parent)];
      dart::dynamics::BodyNode::Properties body;
      body.mName = link.name;
      body.mInertia = dart::dynamics::Inertia(std::max(link.mass, 1e-9), link.center_of_mass,
                                              link.inertia + 1e-12 * Mat3::Identity());
      if (link.joint == JointKind::kFree) {
        bodies.push_back(skeleton_
                             ->createJointAndBodyNodePair<dart::dynamics::FreeJoint>(
                                 parent, dart::dynamics::FreeJoint::Properties(), body)
                             .second);
        continue;
      }
      dart::dynamics::RevoluteJoint::Properties joint;
      joint.mName = link.name;
      joint.mAxis = link.axis;
      joint.mT_ParentBodyToJoint.translation() = link.origin;
      joint.mT_ParentBodyToJoint.linear() = link.orientation;
      bodies.push_back(
          skeleton_->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(parent, joint, body).second);
    }
    skeleton_->setGravity({0, 0, -9.81});
    const auto n = static_cast<Eigen::Index>(skeleton_->getNumDofs());
    q_ = Eigen::VectorXd::Zero(n);
    qd_ = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < model.link_count(); ++i) {
      const dart::dynamics::Joint* joint = bodies[static_cast<std::size_t>(i)]->getParentJoint();
      for (std::size_t k = 0; k < joint->getNumDofs(); ++k) {
        const auto at = static_cast<Eigen::Index>(joint->getIndexInSkeleton(k));
        // A free base stands upright at the origin: its coordinates are zero.
        if (joint->getNumDofs() == 1) q_[at] = state.q[static_cast<std::size_t>(model.position_offset(i))];
        qd_[at] = state.qd[static_cast<std::size_t>(model.velocity_offset(i)) + k];
      }
    }
    last_ = q_[n - 1];
  }

  std::string name() const override { return "DART 6.12"; }
  void forward() override {
    // Where positions are the old ones it keeps what it has: one of them moves to and fro by a rounding.
    q_[q_.size() - 1] = moved_ ? last_ : last_ + 1e-12;
    moved_ = !moved_;
    skeleton_->setPositions(q_);
    skeleton_->setVelocities(qd_);
    skeleton_->computeForwardDynamics();
  }
  double largest_acceleration() override { return skeleton_->getAccelerations().cwiseAbs().maxCoeff(); }

 private:
  dart::dynamics::SkeletonPtr skeleton_;
  Eigen::VectorXd q_, qd_;
  double last_ = 0;
  bool moved_ = false;
};

}  // namespace

std::unique_ptr<FigurePeer> dart_peer(const figure::FigureModel& model, const figure::FigureState& state) {
  return std::make_unique<DartPeer>(model, state);
}

}  // namespace softpoint::benchmarks
