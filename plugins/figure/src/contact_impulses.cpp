#include "contact_impulses.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kLeastMobility = 1e-12;  // 1/kg

}  // namespace

ContactImpulses::ContactImpulses(const FigureModel& model, int sweeps, double settled)
    : placer_(model),
      sweeps_(sweeps),
      settled_(settled),
      rates_(static_cast<std::size_t>(model.velocity_count())) {}

Vec3 ContactImpulses::speed(const FigureDynamics& placed, const Contact& contact) const {
  const LinkMotion m = placed.motion(contact.link);
  return m.velocity + m.angular_velocity.cross(Vec3(contact.point - m.position));
}

void ContactImpulses::assemble(FigureDynamics& dynamics, const double* q,
                               const std::vector<Contact>& contacts, const double* qd,
                               std::span<const Other> others) {
  const std::size_t m = contacts.size();
  changes_.assign(3 * m * rates_, 0.0);
  mobility_.assign(3 * m * m, Vec3::Zero());
  speeds_.assign(m, Vec3::Zero());
  impulses_.assign(m, Vec3::Zero());
  placer_.place(q, qd);
  const auto arm_of = [&](const Contact& c) {
    return Vec3(c.point - others[static_cast<std::size_t>(c.other)].center);
  };
  for (std::size_t i = 0; i < m; ++i) {
    speeds_[i] = speed(placer_, contacts[i]);
    if (contacts[i].other < 0) continue;
    const Other& other = others[static_cast<std::size_t>(contacts[i].other)];
    speeds_[i] -= other.velocity + other.spin.cross(arm_of(contacts[i]));
  }
  for (std::size_t j = 0; j < m; ++j) {
    const Vec3 arm = contacts[j].point - placer_.motion(contacts[j].link).position;
    for (int k = 0; k < 3; ++k) {
      unit_[0] = {contacts[j].link, arm.cross(Vec3(Vec3::Unit(k))), Vec3::Unit(k)};
      double* change = changes_.data() + (3 * j + static_cast<std::size_t>(k)) * rates_;
      dynamics.respond(unit_, change);
      placer_.place(q, change);
      for (std::size_t i = 0; i < m; ++i) {
        Vec3& gain = mobility_[(3 * j + static_cast<std::size_t>(k)) * m + i];
        gain = speed(placer_, contacts[i]);
        if (contacts[j].other < 0 || contacts[i].other != contacts[j].other) continue;
        const Other& other = others[static_cast<std::size_t>(contacts[j].other)];
        const Vec3 spin = other.inverse_inertia * arm_of(contacts[j]).cross(Vec3(Vec3::Unit(k)));
        gain += other.inverse_mass * Vec3(Vec3::Unit(k)) + spin.cross(arm_of(contacts[i]));
      }
    }
  }
}

void ContactImpulses::solve(FigureDynamics& dynamics, const double* q, double friction,
                            const std::vector<Contact>& contacts, double* qd, std::span<const Other> others) {
  assemble(dynamics, q, contacts, qd, others);
  const std::size_t m = contacts.size();
  for (int sweep = 0; sweep < sweeps_; ++sweep) {
    double moved = 0, largest = 0;
    for (std::size_t j = 0; j < m; ++j) {
      Mat3 own;
      for (std::size_t k = 0; k < 3; ++k) own.col(static_cast<int>(k)) = mobility_[(3 * j + k) * m + j];
      const Vec3& n = contacts[j].normal;
      if (!(n.dot(own * n) > kLeastMobility)) continue;  // nothing that could give way
      const Vec3 before = impulses_[j];
      double along = before.dot(n);
      Vec3 across = before - along * n;
      // The normal first, then the rest within the cone it opens.
      along = std::max(0.0, along - (n.dot(speeds_[j]) - contacts[j].lowest) / n.dot(own * n));
      const Vec3 now = speeds_[j] + own * ((along - before.dot(n)) * n);
      across -= (now - now.dot(n) * n) / own.trace();
      const double most = (contacts[j].friction < 0 ? friction : contacts[j].friction) * along;
      if (across.norm() > most) across *= most / across.norm();
      impulses_[j] = along * n + across;
      const Vec3 by = impulses_[j] - before;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < m; ++i)
          speeds_[i] += by[static_cast<int>(k)] * mobility_[(3 * j + k) * m + i];
      }
      moved = std::max(moved, by.norm());
      largest = std::max(largest, impulses_[j].norm());
    }
    if (moved <= settled_ * largest) break;
  }
  for (std::size_t j = 0; j < 3 * m; ++j) {
    const double p = impulses_[j / 3][static_cast<int>(j % 3)];
    for (std::size_t v = 0; v < rates_; ++v) qd[v] += p * changes_[j * rates_ + v];
  }
}

void ContactImpulses::push_out(FigureDynamics& dynamics, const double* q,
                               const std::vector<Contact>& contacts, double* d) {
  std::fill_n(d, rates_, 0.0);
  solve(dynamics, q, 0, contacts, d);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
