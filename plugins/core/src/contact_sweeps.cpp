// The sweeps of the contact solver.
#include <algorithm>
#include <cmath>

#include "contact_solver.h"
#include "index.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Into the cone of friction round the contact's normal.
Vec3 ContactSolver::in_cone(const Contact& contact, const Vec3& impulse) {
  const double push = std::max(contact.normal.dot(impulse), 0.0);
  Vec3 friction = impulse - contact.normal.dot(impulse) * contact.normal;
  const double limit = contact.friction * push, length = friction.norm();
  if (length > limit) {
    friction *= limit / length;
  }
  return push * contact.normal + friction;
}

double ContactSolver::sweep_contacts(std::vector<Contact>& contacts, RigidStates& rigid) {
  double largest = 0.0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    Contact& contact = contacts[c];
    if (!contact.seen) {
      continue;
    }
    const Row& row = rows_[c];
    const Vec3& n = contact.normal;
    const Vec3 motion = moved(contact, row, &TouchedPoints::displacement) -
                        dt_ * rigid[contact.rigid].velocity_of(contact.arm);
    // Signorini: gap >= 0, push >= 0, one of them zero.
    const double gap = row.gap_base + n.dot(motion) - dt_ * contact.rebound;
    const double push = n.dot(contact.impulse);
    double new_push = std::max(0.0, push - gap * row.normal_gain);
    constexpr double kNothing = 1e-14;  // m; a push that moves less is fading out
    if (new_push < kNothing * row.normal_gain) {
      new_push = 0.0;
    }
    if (new_push == 0.0 && contact.impulse == Vec3::Zero()) {
      continue;
    }
    Vec3 change = (new_push - push) * n;
    // Coulomb: no slip over the step inside the cone, friction against the slip on it.
    const Vec3 slip_vector = row.slip_base + motion + row.compliance * change;
    const Eigen::Vector2d slip(row.tangent_a.dot(slip_vector), row.tangent_b.dot(slip_vector));
    const Eigen::Vector2d old_friction(row.tangent_a.dot(contact.impulse),
                                       row.tangent_b.dot(contact.impulse));
    const double limit = contact.friction * new_push;
    Eigen::Vector2d friction = old_friction - row.tangent_inverse * slip;
    if (friction.norm() > limit) {
      // It slips: a scalar step, so that friction ends up straight against the slip.
      friction = old_friction - row.tangent_gain * slip;
      const double length = friction.norm();
      if (length > limit) {
        friction *= limit / length;
      }
    }
    change +=
        (friction.x() - old_friction.x()) * row.tangent_a + (friction.y() - old_friction.y()) * row.tangent_b;
    contact.impulse += change;
    add_impulse(contact, row, change, rigid);
    largest = std::max(largest, (row.compliance * change).norm());
  }
  return largest;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
