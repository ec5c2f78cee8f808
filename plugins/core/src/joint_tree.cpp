#include "joint_tree.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

Eigen::Quaterniond quaternion_of(const btQuaternion& q) {
  return Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized();
}

Eigen::Quaterniond about(const Vec3& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}

}  // namespace

void JointTree::read(const btMultiBody& body, std::span<const double> velocity, double dt) {
  links_.resize(at(body.getNumLinks()) + 1);
  dofs_ = body.getNumDofs();
  Link& base = links_.front();
  base.parent = -1;
  base.first_dof = 0;
  base.dof_count = 6;
  base.frozen = body.isBaseStaticOrKinematic();
  base.still = false;  // Bullet moves even a fixed base by its velocity
  base.start = {quaternion_of(body.getWorldToBaseRot()).conjugate().toRotationMatrix(),
                from_bullet(body.getBasePos())};
  if (body.isBaseKinematic()) {
    base.start.rotation = bullet_turn({-velocity[0], -velocity[1], -velocity[2]}, dt) * base.start.rotation;
    base.start.origin -= dt * Vec3(velocity[3], velocity[4], velocity[5]);
  }
  for (int i = 0; i < body.getNumLinks(); ++i) {
    const btMultibodyLink& from = body.getLink(i);
    Link& link = links_[at(i) + 1];
    link.parent = from.m_parent + 1;
    link.first_dof = 6 + from.m_dofOffset;
    link.dof_count = from.m_dofCount;
    link.joint = from.m_jointType;
    const btMultiBodyLinkCollider* collider = from.m_collider;
    link.frozen = collider != nullptr && collider->isStaticOrKinematicObject();
    link.still = link.frozen && !collider->isKinematicObject();
    link.zero_rotation = quaternion_of(from.m_zeroRotParentToThis);
    link.pivot_to_center = from_bullet(from.m_dVector);
    link.parent_to_pivot = from_bullet(from.m_eVector);
    for (int dof = 0; dof < link.dof_count; ++dof) {
      link.top[at(dof)] = from_bullet(from.getAxisTop(dof));
      link.bottom[at(dof)] = from_bullet(from.getAxisBottom(dof));
    }
    std::copy_n(from.m_jointPos, 4, link.position.begin());
    if (link.frozen && !link.still) {
      link.position = stepped(link, velocity.data() + link.first_dof, -dt);
    }
    link.start = placed(link, links_[at(link.parent)].start, link.position);
  }
}

// Bullet's rules (stepPositionsMultiDof).
std::array<double, 4> JointTree::stepped(const Link& link, const double* velocity, double dt) {
  std::array<double, 4> q = link.position;
  switch (link.joint) {
    case btMultibodyLink::ePrismatic:
    case btMultibodyLink::eRevolute:
      q[0] += dt * velocity[0];
      break;
    case btMultibodyLink::eSpherical: {
      const Eigen::Quaterniond old(q[3], q[0], q[1], q[2]);
      const Eigen::Quaterniond turned =
          (bullet_turn_quaternion(old * Vec3(velocity[0], velocity[1], velocity[2]), dt) * old).normalized();
      q = {turned.x(), turned.y(), turned.z(), turned.w()};
      break;
    }
    case btMultibodyLink::ePlanar: {
      q[0] += dt * velocity[0];
      const Vec3 slide =
          about(link.top[0], q[0]) * Vec3(velocity[1] * link.bottom[1] + velocity[2] * link.bottom[2]);
      q[1] += dt * link.bottom[1].dot(slide);
      q[2] += dt * link.bottom[2].dot(slide);
      break;
    }
    default:
      break;
  }
  return q;
}

// Bullet's rules (updateCacheMultiDof, updateCollisionObjectWorldTransforms).
Pose JointTree::placed(const Link& link, const Pose& parent, const std::array<double, 4>& q) {
  Eigen::Quaterniond from_parent = link.zero_rotation;
  Vec3 slide = Vec3::Zero();
  switch (link.joint) {
    case btMultibodyLink::eRevolute:
      from_parent = about(link.top[0], -q[0]) * from_parent;
      break;
    case btMultibodyLink::ePrismatic:
      slide = q[0] * link.bottom[0];
      break;
    case btMultibodyLink::eSpherical:
      from_parent = Eigen::Quaterniond(-q[3], q[0], q[1], q[2]).normalized() * from_parent;
      break;
    case btMultibodyLink::ePlanar: {
      const Eigen::Quaterniond turn = about(link.top[0], -q[0]);
      from_parent = turn * from_parent;
      slide = turn * Vec3(q[1] * link.bottom[1] + q[2] * link.bottom[2]);
      break;
    }
    default:
      break;
  }
  const Vec3 offset = link.pivot_to_center + slide + from_parent * link.parent_to_pivot;
  Pose pose;
  pose.rotation = parent.rotation * from_parent.conjugate().toRotationMatrix();
  pose.origin = parent.origin + pose.rotation * offset;
  return pose;
}

Pose JointTree::end(int body, std::span<const double> velocity, double dt) const {
  const Link& link = links_[at(body)];
  if (body == 0) {
    return {bullet_turn_quaternion({velocity[0], velocity[1], velocity[2]}, dt) * link.start.rotation,
            link.start.origin + dt * Vec3(velocity[3], velocity[4], velocity[5])};
  }
  const Pose parent = end(link.parent, velocity, dt);
  return placed(link, parent,
                link.still ? link.position : stepped(link, velocity.data() + link.first_dof, dt));
}

}  // namespace softpoint::inline SOFTPOINT_ABI
