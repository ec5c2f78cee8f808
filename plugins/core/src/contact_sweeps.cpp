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

void ContactSolver::find_clusters(const std::vector<Contact>& contacts, const RigidStates& rigid) {
  // Nodes: the touched points of all bodies, then the colliders. What hangs
  // together is joined to its first point.
  std::size_t nodes = 0;
  for (const TouchedPoints& touched : touched_) nodes += touched.points.size();
  const std::size_t first_rigid = nodes;
  std::size_t colliders = 0;
  for (const Contact& contact : contacts) colliders = std::max(colliders, at(contact.rigid + 1));
  joined_.resize(nodes + colliders);
  for (std::size_t i = 0; i < joined_.size(); ++i) joined_[i] = static_cast<int>(i);
  const auto root = [&](std::size_t node) {
    while (joined_[node] != static_cast<int>(node)) node = at(joined_[node] = joined_[at(joined_[node])]);
    return node;
  };
  const auto join = [&](std::size_t a, std::size_t b) { joined_[root(a)] = static_cast<int>(root(b)); };
  std::size_t first = 0;
  for (const TouchedPoints& touched : touched_) {
    for (std::size_t j = 0; j < touched.points.size(); ++j) {
      join(first + j, first + at(touched.runs[at(touched.part[j])].front()[0]));
    }
    first += touched.points.size();
  }
  const auto first_of = [&](int body) {
    std::size_t sum = 0;
    for (std::size_t b = 0; b < at(body); ++b) sum += touched_[b].points.size();
    return sum;
  };
  const auto node_of = [&](std::size_t c) { return first_of(contacts[c].body) + at(rows_[c].local[0]); };
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    const std::size_t body = first_of(contact.body);
    for (std::size_t k = 1; k < at(contact.count); ++k) join(node_of(c), body + at(rows_[c].local[k]));
    if (contact.other_body >= 0) {
      const std::size_t other = first_of(contact.other_body);
      for (std::size_t k = 0; k < at(contact.other_count); ++k)
        join(node_of(c), other + at(rows_[c].other_local[k]));
    } else if (!rigid[contact.rigid].inverse_mass.isZero(0)) {
      join(node_of(c), first_rigid + at(contact.rigid));
    }
  }
  clusters_ = 0;
  for (std::vector<int>& members : members_) members.clear();
  std::vector<int>& names = cluster_of_;
  names.assign(joined_.size(), -1);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (!contacts[c].seen) continue;
    int& name = names[root(node_of(c))];
    if (name < 0) name = static_cast<int>(clusters_++);
    if (members_.size() < clusters_) members_.emplace_back();
    members_[at(name)].push_back(static_cast<int>(c));
  }
  if (accelerations_.size() < clusters_) accelerations_.resize(clusters_);
}

// Before a sweep: from what the last ones changed, cluster by cluster.
void ContactSolver::accelerate(std::vector<Contact>& contacts, RigidStates& rigid) {
  const bool begins = !accelerating_;
  if (begins) find_clusters(contacts, rigid);
  accelerating_ = true;
  for (std::size_t cluster = 0; cluster < clusters_; ++cluster) {
    SweepAcceleration& acceleration = accelerations_[cluster];
    const std::vector<int>& members = members_[cluster];
    bool better = false;
    if (begins) {
      acceleration.begin(members.size());
      for (std::size_t m = 0; m < members.size(); ++m) {
        acceleration.weight(m) = std::sqrt(rows_[at(members[m])].compliance.trace());
      }
    } else {
      for (std::size_t m = 0; m < members.size(); ++m)
        acceleration.after(m) = contacts[at(members[m])].impulse;
      better = acceleration.improve();
    }
    for (std::size_t m = 0; m < members.size(); ++m) {
      Contact& contact = contacts[at(members[m])];
      if (better) {
        const Vec3 impulse = in_cone(contact, acceleration.after(m));
        const Vec3 change = impulse - contact.impulse;
        contact.impulse = impulse;
        if (change != Vec3::Zero()) add_impulse(contact, rows_[at(members[m])], change, rigid);
      }
      acceleration.before(m) = contact.impulse;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
