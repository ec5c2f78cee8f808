// Poses of multibody links at the end of a step against Bullet's own integrator, for every kind of joint.
#include "joint_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/multibodies.h"
#include "support/precision.h"

namespace softpoint {
namespace {

using Joint = ChainSettings::Joint;

TEST(JointTree, EndsWhereBulletsIntegratorEnds) {
  for (const double speed : {0.1, 3.0, 60.0}) {
    for (const Joint joint : {Joint::hinge, Joint::slider, Joint::ball, Joint::planar, Joint::fixed}) {
      TestWorld world(WorldKind::multibody);
      Multibodies multibodies(world);
      btMultiBody& chain = multibodies.add_chain(
          {.links = 4, .fixed_base = false, .joint = joint, .axis = Vec3(0.2, 0.3, 1).normalized()});
      chain.setBaseWorldTransform(
          btTransform(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.7)), btVector3(1, 2, 3)));
      for (int i = 0; i < 4; ++i) {
        const btQuaternion turned(btVector3(1, 0, btScalar(i)).normalized(), btScalar(0.4 + 0.2 * i));
        const btScalar q[7] = {joint == Joint::ball ? turned.x() : btScalar(0.3 - 0.1 * i),
                               joint == Joint::ball ? turned.y() : btScalar(0.02),
                               joint == Joint::ball ? turned.z() : btScalar(-0.03),
                               joint == Joint::ball ? turned.w() : btScalar(0),
                               0,
                               0,
                               0};
        chain.setJointPosMultiDof(i, q);
      }
      std::vector<double> velocity(static_cast<std::size_t>(6 + chain.getNumDofs()));
      for (std::size_t k = 0; k < velocity.size(); ++k) {
        velocity[k] = btScalar(speed * std::sin(1.0 + 2.3 * double(k)));
      }
      MultibodyState state = MultibodyState::of(chain);
      state.velocities.assign(velocity.begin(), velocity.end());
      state.put_velocities(chain);
      const double dt = 1.0 / 60.0;
      JointTree tree;
      tree.read(chain, velocity, dt);
      std::vector<Pose> ends;
      for (int b = 0; b < tree.bodies(); ++b) {
        ends.push_back(tree.end(b, velocity, dt));
      }
      chain.stepPositionsMultiDof(btScalar(dt));
      Multibodies::place(chain);
      double worst = 0;
      for (int b = 0; b < tree.bodies(); ++b) {
        const Pose there = from_bullet(
            (b == 0 ? chain.getBaseCollider() : chain.getLinkCollider(b - 1))->getWorldTransform());
        worst = std::max(worst, (there.origin - ends[static_cast<std::size_t>(b)].origin).norm());
        worst = std::max(worst, (there.rotation - ends[static_cast<std::size_t>(b)].rotation).norm());
      }
      EXPECT_LE(worst, by_precision(1e-14, 5e-6)) << "speed " << speed << ", joint " << int(joint);
    }
  }
}

}  // namespace
}  // namespace softpoint
