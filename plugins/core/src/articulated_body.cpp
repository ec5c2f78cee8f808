#include "articulated_body.h"

#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI {

void ArticulatedBody::read(btMultiBody& body, double dt) {
  body_ = &body;
  used_ = 0;
  const int n = 6 + body.getNumDofs();
  velocity_.resize(n);
  for (int i = 0; i < n; ++i) {
    // Bullet adds the second right after solving, and the third (split impulses) for the step of positions.
    velocity_[i] = double(body.getVelocityVector()[i]) + double(body.getDeltaVelocityVector()[i]) +
                   double(body.getSplitVelocityVector()[i]);
  }
  tree_.read(body, {velocity_.data(), at(n)}, dt);
  for (int link = 1; link < tree_.bodies(); ++link) {
    if (tree_.still(link)) {
      velocity_.segment(tree_.first_dof(link), tree_.dof_count(link)).setZero();
    }
  }
  change_.setZero(n);
  free_change_.setZero(n);
  end_velocity_.resize(n);
  scratch_.resize(at(n));
  stride_ = tree_.bodies();
  responses_.resize(at(stride_ * stride_));
  factorize(body);
}

// Twist of a body's centre of mass per coordinate velocity: those of all joints between it and the base.
void ArticulatedBody::fill_jacobian(int body, Eigen::Matrix<double, 6, Eigen::Dynamic>& jacobian) const {
  jacobian.setZero(6, tree_.coordinates());
  const Vec3& point = tree_.start(body).origin;
  jacobian.block<3, 3>(0, 0) = -cross_matrix(point - tree_.start(0).origin);
  jacobian.block<3, 3>(3, 0).setIdentity();
  jacobian.block<3, 3>(0, 3).setIdentity();
  for (int link = body; link > 0; link = tree_.parent(link)) {
    const Vec3 arm = point - tree_.start(link).origin;
    for (int dof = 0; dof < tree_.dof_count(link); ++dof) {
      const Vec3 turn = tree_.angular_axis(link, dof);
      jacobian.col(tree_.first_dof(link) + dof) << tree_.linear_axis(link, dof) + turn.cross(arm), turn;
    }
  }
}

// Mass matrix M = sum J^T diag(m, I) J over the bodies, factored in place as M = L^T L. Coordinates are only
// coupled along the tree, and this order keeps it so (R. Featherstone, Rigid Body Dynamics Algorithms, ch.
// 6).
void ArticulatedBody::factorize(const btMultiBody& body) {
  const int n = tree_.coordinates();
  ancestor_.assign(at(n), -1);
  pivot_.assign(at(n), 0);
  for (int b = 0; b < tree_.bodies(); ++b) {
    int towards_base = -1;
    for (int link = b == 0 ? -1 : tree_.parent(b); link >= 0; link = link == 0 ? -1 : tree_.parent(link)) {
      if (tree_.dof_count(link) > 0) {
        towards_base = tree_.first_dof(link) + tree_.dof_count(link) - 1;
        break;
      }
    }
    for (int dof = 0; dof < tree_.dof_count(b); ++dof) {
      const int i = tree_.first_dof(b) + dof;
      ancestor_[at(i)] = towards_base;
      pivot_[at(i)] = !tree_.frozen(b);
      towards_base = i;
    }
  }
  factor_.setZero(n, n);
  for (int b = 0; b < tree_.bodies(); ++b) {
    const double mass = b == 0 ? body.getBaseMass() : body.getLinkMass(b - 1);
    const Mat3& turn = tree_.start(b).rotation;
    const Vec3 local = from_bullet(b == 0 ? body.getBaseInertia() : body.getLinkInertia(b - 1));
    const Mat3 inertia = turn * local.asDiagonal() * turn.transpose();
    fill_jacobian(b, link_jacobian_);
    int last = b;
    while (last > 0 && tree_.dof_count(last) == 0) {
      last = tree_.parent(last);
    }
    for (int i = tree_.first_dof(last) + tree_.dof_count(last) - 1; i >= 0; i = ancestor_[at(i)]) {
      const Vec3 momentum = mass * link_jacobian_.col(i).head<3>();
      const Vec3 spin = inertia * link_jacobian_.col(i).tail<3>();
      for (int j = i; j >= 0; j = ancestor_[at(j)]) {
        factor_(i, j) +=
            momentum.dot(link_jacobian_.col(j).head<3>()) + spin.dot(link_jacobian_.col(j).tail<3>());
      }
    }
  }
  constexpr double kNothing =
      1e-12;  // of its own inertia: what is left for a coordinate that others carry along
  scratch_diagonal_ = factor_.diagonal();
  for (int k = n - 1; k >= 0; --k) {
    if (pivot_[at(k)] == 0 || !(factor_(k, k) > kNothing * scratch_diagonal_[k])) {
      pivot_[at(k)] = 0;
      continue;
    }
    factor_(k, k) = std::sqrt(factor_(k, k));
    for (int i = ancestor_[at(k)]; i >= 0; i = ancestor_[at(i)]) {
      factor_(k, i) /= factor_(k, k);
    }
    for (int i = ancestor_[at(k)]; i >= 0; i = ancestor_[at(i)]) {
      for (int j = i; j >= 0; j = ancestor_[at(j)]) {
        factor_(i, j) -= factor_(k, i) * factor_(k, j);
      }
    }
  }
}

void ArticulatedBody::solve(Eigen::Ref<Eigen::VectorXd> x) const {
  const int n = tree_.coordinates();
  for (int i = n - 1; i >= 0; --i) {
    x[i] = pivot_[at(i)] != 0 ? x[i] / factor_(i, i) : 0.0;
    for (int j = ancestor_[at(i)]; j >= 0; j = ancestor_[at(j)]) {
      x[j] -= factor_(i, j) * x[i];
    }
  }
  for (int i = 0; i < n; ++i) {
    if (pivot_[at(i)] == 0) {
      x[i] = 0.0;
      continue;
    }
    for (int j = ancestor_[at(i)]; j >= 0; j = ancestor_[at(j)]) {
      x[i] -= factor_(i, j) * x[j];
    }
    x[i] /= factor_(i, i);
  }
}

int ArticulatedBody::touch(int link) {
  for (int s = 0; s < used_; ++s) {
    if (slots_[at(s)].body == link + 1) {
      return s;
    }
  }
  const int added = used_++;
  if (slots_.size() < at(used_)) {
    slots_.emplace_back();
  }
  Slot& slot = slots_[at(added)];
  slot.body = link + 1;
  slot.impulse.setZero();
  fill_jacobian(slot.body, slot.jacobian);
  slot.answer = slot.jacobian.transpose();
  for (int column = 0; column < 6; ++column) {
    solve(slot.answer.col(column));
  }
  slot.movable = false;
  for (int other = 0; other < used_; ++other) {
    Response& there = responses_[at(other * stride_ + added)];
    there = slots_[at(other)].jacobian.lazyProduct(slot.answer);
    responses_[at(added * stride_ + other)] = there.transpose();
  }
  slot.movable = response(added, added).diagonal().maxCoeff() > 0.0;
  return added;
}

void ArticulatedBody::push(int slot, const Twist& impulse) {
  slots_[at(slot)].impulse += impulse;
  change_ += slots_[at(slot)].answer.lazyProduct(impulse);
}

void ArticulatedBody::push_free(int slot, const Twist& impulse) {
  free_change_ += slots_[at(slot)].answer.lazyProduct(impulse);
}

Pose ArticulatedBody::end(int slot, double dt) const {
  end_velocity_ = velocity_ + change_;
  return tree_.end(slots_[at(slot)].body, {end_velocity_.data(), at(tree_.coordinates())}, dt);
}

void ArticulatedBody::write_back() {
  if (!change_.allFinite()) {
    return;  // the guard: Bullet keeps what it had
  }
  for (std::size_t i = 0; i < scratch_.size(); ++i) {
    scratch_[i] = static_cast<btScalar>(change_[static_cast<Eigen::Index>(i)]);
  }
  body_->applyDeltaVeeMultiDof2(scratch_.data(), 1);
  body_->setPosUpdated(false);  // Runge-Kutta steps of positions would leave the impulses out
  wake();
}

void ArticulatedBody::load(bool as_forces, double dt) {
  if (!change_.allFinite()) {
    return;
  }
  wake();
  if (!as_forces) {
    for (std::size_t i = 0; i < scratch_.size(); ++i) {
      scratch_[i] = static_cast<btScalar>(change_[static_cast<Eigen::Index>(i)]);
    }
    body_->applyDeltaVeeMultiDof(scratch_.data(), 1);
    return;
  }
  // As velocities they would change the gyroscopic forces that Bullet is about to compute.
  for (int s = 0; s < used_; ++s) {
    const Slot& slot = slots_[at(s)];
    lent_.push_back(
        {slot.body - 1, to_bullet(slot.impulse.head<3>() / dt), to_bullet(slot.impulse.tail<3>() / dt)});
    add_force(lent_.back().link, lent_.back().force, lent_.back().torque);
  }
}

void ArticulatedBody::take_back_forces() {
  for (const Lent& lent : lent_) {
    add_force(lent.link, -lent.force, -lent.torque);
  }
  lent_.clear();
}

void ArticulatedBody::add_force(int link, const btVector3& force, const btVector3& torque) {
  if (link < 0) {
    body_->addBaseForce(force);
    body_->addBaseTorque(torque);
  } else {
    body_->addLinkForce(link, force);
    body_->addLinkTorque(link, torque);
  }
}

void ArticulatedBody::wake() {
  body_->wakeUp();
  for (int link = -1; link < body_->getNumLinks(); ++link) {
    btMultiBodyLinkCollider* collider = link < 0 ? body_->getBaseCollider() : body_->getLinkCollider(link);
    if (collider != nullptr && !collider->isActive() &&
        collider->getActivationState() != FIXED_BASE_MULTI_BODY) {
      collider->activate(true);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
