#include "paper_cloth.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// The kernels know one rest length for each of the four directions of springs.
void check_grid(const ClothPattern& pattern) {
  check(pattern);
  if (pattern.columns < 2 || pattern.columns * pattern.rows != pattern.point_count()) {
    throw Error("paper: the pattern must be a grid; it has " + std::to_string(pattern.columns) +
                " columns and " + std::to_string(pattern.rows) + " rows for " +
                std::to_string(pattern.point_count()) + " points");
  }
  double rest[4] = {0, 0, 0, 0};
  for (const Spring& spring : pattern.springs) {
    const int columns = spring.b % pattern.columns - spring.a % pattern.columns;
    const int rows = spring.b / pattern.columns - spring.a / pattern.columns;
    const int family = rows == 0 ? 0 : columns == 0 ? 1 : columns > 0 ? 2 : 3;
    if (std::abs(columns) > 1 || rows > 1)
      throw Error("paper: a spring of the pattern skips a point of the grid");
    if (rest[family] == 0) rest[family] = spring.rest;
    if (std::abs(spring.rest - rest[family]) > 1e-6 * spring.rest) {
      throw Error("paper: springs along one direction must have one length, not " + to_text(rest[family]) +
                  " and " + to_text(spring.rest));
    }
  }
}

Vec3 cubic(const Vec3& a, const Vec3& va, const Vec3& b, const Vec3& vb, double dt, double s) {
  const double s2 = s * s, s3 = s2 * s;
  return (2 * s3 - 3 * s2 + 1) * a + (s3 - 2 * s2 + s) * dt * va + (3 * s2 - 2 * s3) * b +
         (s3 - s2) * dt * vb;
}

}  // namespace

PaperCloth::PaperCloth(ClothPattern pattern, const Fabric& fabric, const PaperSettings& settings)
    : pattern_(std::move(pattern)), fabric_(fabric), settings_(settings) {
  check(fabric_);
  check(settings_);
  check_grid(pattern_);
  const PaperModel model{pattern_, fabric_, settings_};
  stepper_ = settings_.simd ? make_simd_paper_stepper(model) : make_scalar_paper_stepper(model);
  positions_ = pattern_.points;
  velocities_.assign(positions_.size(), Vec3::Zero());
}

void PaperCloth::set_state(std::span<const Vec3> positions, std::span<const Vec3> velocities) {
  for (int i = 0; i < point_count(); ++i) {
    positions_[i] = positions[i];
    velocities_[i] = velocities[i];
    stepper_->set_point(i, into(positions[i]), axes_ * velocities[i]);
  }
}

void PaperCloth::set_plane(const Vec3& normal, const Vec3& foot) {
  if (axes_.row(2).transpose() == normal && origin_ == foot) return;
  axes_ = Eigen::Quaterniond::FromTwoVectors(normal, Vec3::UnitZ()).toRotationMatrix();
  axes_.row(2) = normal.transpose();
  origin_ = foot;
  const std::vector<Vec3> positions = positions_, velocities = velocities_;
  set_state(positions, velocities);
}

double PaperCloth::gauge_of(double volume) const {
  if (!air_on_) return 0;
  return (air_ > 0 ? air_ / volume : 0) - ambient_;  // (3.9)
}

// Velocities that take the held points along their way.
void PaperCloth::guide(double from, double to, double dt) {
  for (std::size_t k = 0; k < hands_.size(); ++k) {
    const PaperHand& hand = hands_[k];
    const Vec3 goal =
        cubic(starts_[k], start_velocities_[k], into(hand.target), axes_ * hand.velocity, dt, to);
    stepper_->set_velocity(hand.point, (goal - stepper_->position(hand.point)) / ((to - from) * dt));
  }
}

int PaperCloth::step(double dt) {
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / settings_.step - 1e-6)));
  const double h = dt / steps;
  starts_.resize(hands_.size());
  start_velocities_.resize(hands_.size());
  for (std::size_t k = 0; k < hands_.size(); ++k) {
    starts_[k] = stepper_->position(hands_[k].point);
    start_velocities_[k] = stepper_->velocity(hands_[k].point);
  }
  const Vec3 gravity = axes_ * gravity_;
  for (int i = 0; i < steps; ++i) {
    const double gauge = gauge_of(stepper_->forces());
    stepper_->accelerate(h, gauge, gravity);
    stepper_->collide(h);
    guide(static_cast<double>(i) / steps, (i + 1.0) / steps, dt);
    stepper_->move(h, gauge, gravity, friction_);
  }
  for (int i = 0; i < point_count(); ++i) {
    positions_[i] = axes_.transpose() * stepper_->position(i) + origin_;
    velocities_[i] = axes_.transpose() * stepper_->velocity(i);
  }
  return steps;
}

double PaperCloth::volume() const {
  double volume = 0;
  for (const Triangle& t : pattern_.faces) {
    const Vec3 a = into(positions_[t[0]]), b = into(positions_[t[1]]), c = into(positions_[t[2]]);
    volume += (b - a).cross(c - a).z() * (a.z() + b.z() + c.z()) / 6;
  }
  return volume;
}

double PaperCloth::gauge() const { return gauge_of(volume()); }

Vec3 PaperCloth::hand_force(int point) const {
  Vec3 force = pattern_.masses[point] * gravity_;
  for (const Spring& s : pattern_.springs) {
    if (s.a != point && s.b != point) continue;
    const Vec3 away = positions_[s.a == point ? s.b : s.a] - positions_[point];
    const double stretch = away.norm() - s.rest;
    const double k = stretch < 0 ? s.stiffness * fabric_.compression_ratio : s.stiffness;
    force += k * stretch * away.normalized();
  }
  Vec3 area = Vec3::Zero();
  for (const Triangle& t : pattern_.faces) {
    for (int k = 0; k < 3; ++k) {
      if (t[k] != point) continue;
      const Vec3 a = into(positions_[t[k]]), b = into(positions_[t[(k + 1) % 3]]),
                 c = into(positions_[t[(k + 2) % 3]]);
      const double height = (a.z() + b.z() + c.z()) / 6;
      area += Vec3(height * (b.y() - c.y()), height * (c.x() - b.x()), (b - a).cross(c - a).z() / 6);
    }
  }
  return -(force + gauge() * (axes_.transpose() * area));
}

double PaperCloth::kinetic_energy() const {
  double energy = 0;
  for (int i = 0; i < point_count(); ++i) energy += 0.5 * pattern_.masses[i] * velocities_[i].squaredNorm();
  return energy;
}

double PaperCloth::potential_energy() const {
  double energy = 0;
  for (int i = 0; i < point_count(); ++i) energy -= pattern_.masses[i] * gravity_.dot(positions_[i]);
  for (const Spring& s : pattern_.springs) {
    const double stretch = (positions_[s.b] - positions_[s.a]).norm() - s.rest;
    energy += 0.5 * (stretch < 0 ? s.stiffness * fabric_.compression_ratio : s.stiffness) * stretch * stretch;
  }
  if (!air_on_) return energy;
  const double v = volume();
  return energy + ambient_ * v - (air_ > 0 ? air_ * std::log(v) : 0);
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
