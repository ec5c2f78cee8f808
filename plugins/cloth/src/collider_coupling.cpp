#include "collider_coupling.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

using Twist = Eigen::Matrix<double, 6, 1>;
using Block = Eigen::Matrix<double, 6, 6>;
using Arm = Eigen::Matrix<double, 3, 6>;

// Part of the limit of friction from which a point counts as sliding.
constexpr double kSliding = 0.999;
// m; air thinner than this gives way as if it were this thick.
constexpr double kThinAir = 1e-5;

// Motion of a point at `arm` from the centre by a shift and a small turn.
Arm motion_at(const Vec3& arm) {
  Arm m;
  m.leftCols<3>().setIdentity();
  m.rightCols<3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return m;
}

}  // namespace

ColliderCoupling::ColliderCoupling(const ClothPattern& pattern) {
  rides_.assign(pattern.points.size(), 0);
  spring_begin_.assign(pattern.points.size() + 1, 0);
  for (const Spring& spring : pattern.springs) {
    ++spring_begin_[static_cast<std::size_t>(spring.a) + 1];
    ++spring_begin_[static_cast<std::size_t>(spring.b) + 1];
  }
  for (std::size_t v = 0; v < pattern.points.size(); ++v) {
    spring_begin_[v + 1] += spring_begin_[v];
  }
  spring_list_.resize(2 * pattern.springs.size());
  std::vector<int> next(spring_begin_.begin(), spring_begin_.end() - 1);
  for (std::size_t i = 0; i < pattern.springs.size(); ++i) {
    for (const int v : {pattern.springs[i].a, pattern.springs[i].b}) {
      spring_list_[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] = static_cast<int>(i);
    }
  }
  riders_.reserve(pattern.points.size());
}

void ColliderCoupling::begin(const NearColliders& near, std::span<const PointContacts> contacts) {
  any_movable_ = false;
  for (int c = 0; c < near.colliders(); ++c) {
    any_movable_ |= near.collider(c).movable;
  }
  points_.clear();
  if (!any_movable_) {
    return;
  }
  for (std::size_t v = 0; v < contacts.size(); ++v) {
    for (int k = 0; k < contacts[v].count; ++k) {
      if (near.collider(contacts[v].planes[k].collider).movable) {
        points_.push_back(static_cast<int>(v));
        break;
      }
    }
  }
}

// Two pushes along the two normals that make up the force as well as pushes can; what is left is friction on
// the plane that is pushed harder.
void ColliderCoupling::split(const PointContacts& contacts, const Vec3& force, Vec3 (&parts)[2]) {
  parts[0] = force;
  parts[1].setZero();
  if (contacts.count < 2) {
    return;
  }
  const Vec3 &a = contacts.planes[0].normal, &b = contacts.planes[1].normal;
  const double c = a.dot(b), fa = force.dot(a), fb = force.dot(b), det = 1.0 - c * c;
  double pa = (fa - c * fb) / det, pb = (fb - c * fa) / det;
  if (pa < 0.0) {
    pa = 0.0;
    pb = std::max(fb, 0.0);
  } else if (pb < 0.0) {
    pb = 0.0;
    pa = std::max(fa, 0.0);
  }
  const Vec3 rest = force - pa * a - pb * b;
  parts[0] = pa * a;
  parts[1] = pb * b;
  parts[pa >= pb ? 0 : 1] += rest;
}

void ColliderCoupling::collect_riders(int collider, const ClothSolver& solver, const Points& points) {
  std::fill(rides_.begin(), rides_.end(), 0);
  riders_.clear();
  for (const int point : points_) {
    const auto v = static_cast<std::size_t>(point);
    const bool held = std::any_of(points.hands.begin(), points.hands.end(), [&](const ClothHand& hand) {
      return hand.point == point && std::isinf(hand.max_force);
    });
    if (!solver.touching(point) || held) {
      continue;
    }
    Vec3 parts[2];
    split(points.contacts[v], solver.contact_force(point), parts);
    for (int k = 0; k < points.contacts[v].count; ++k) {
      const ContactPlane& plane = points.contacts[v].planes[k];
      if (plane.collider != collider || parts[k].isZero(0)) {
        continue;
      }
      const double push = plane.normal.dot(parts[k]);
      const double along = (parts[k] - push * plane.normal).norm();
      riders_.push_back(
          {point, along >= kSliding * plane.friction * (push + plane.adhesion), plane.normal, parts[k]});
      rides_[v] = 1;
    }
  }
}

bool ColliderCoupling::balance(NearColliders& near, double h, const ClothSolver& solver, const Points& points,
                               const Air& air) {
  bool moved = false;
  for (int c = 0; c < near.colliders(); ++c) {
    if (near.collider(c).movable) {
      moved |= balance_one(c, near, h, solver, points, air);
    }
  }
  return moved;
}

// With the collider's mobility W, its displacement d beyond the one that the small step saw obeys
// d = h2 W (r - S d): r is the wrench of the cloth on it, S how that gives way when riders go along.
bool ColliderCoupling::balance_one(int collider, NearColliders& near, double h, const ClothSolver& solver,
                                   const Points& points, const Air& air) {
  collect_riders(collider, solver, points);
  const Vec3 center = near.center(collider);
  Twist wrench = Twist::Zero();
  Block stiffness = Block::Zero();
  for (const Rider& rider : riders_) {
    const auto v = static_cast<std::size_t>(rider.point);
    const Arm arm = motion_at(points.positions[v] - center);
    wrench -= arm.transpose() * rider.force;
    Mat3 gives = points.masses[v] / (h * h) * Mat3::Identity();
    for (int s = spring_begin_[v]; s < spring_begin_[v + 1]; ++s) {
      const Spring& spring =
          points.springs[static_cast<std::size_t>(spring_list_[static_cast<std::size_t>(s)])];
      const int other = spring.a == rider.point ? spring.b : spring.a;
      if (rides_[static_cast<std::size_t>(other)]) {
        continue;
      }
      const Vec3 along = points.positions[static_cast<std::size_t>(other)] - points.positions[v];
      const double length = along.norm();
      if (length > 0.0) {
        const double across = std::max(1.0 - spring.rest / length, 0.0);
        const Vec3 unit = along / length;
        gives += spring.stiffness * (across * Mat3::Identity() + (1.0 - across) * unit * unit.transpose());
      }
    }
    if (rider.slides) {
      const Mat3 normal = rider.normal * rider.normal.transpose();
      gives = normal * gives * normal;
    }
    stiffness += arm.transpose() * gives * arm;
  }
  if (!air.foot_forces.empty()) {
    for (std::size_t v = 0; v < air.foot_forces.size(); ++v) {
      if (air.colliders[v] == collider) {
        wrench += motion_at(air.feet[v] - center).transpose() * air.foot_forces[v];
      }
    }
    for (std::size_t p = 0; p < air.pockets.size(); ++p) {
      const AirPocket& pocket = air.pockets[p];
      if (pocket.open) {
        continue;
      }
      // What the bubble's volume changes by when the collider and its riders move: all but the other points.
      Twist change = Twist::Zero();
      double area = 0;
      for (std::size_t f = 0; f < air.faces.size(); ++f) {
        if (air.face_pockets[f] != static_cast<int>(p)) {
          continue;
        }
        const Triangle& t = air.faces[f];
        for (std::size_t k = 0; k < 3; ++k) {
          const auto v = static_cast<std::size_t>(t[k]);
          const auto next = static_cast<std::size_t>(t[(k + 1) % 3]),
                     after = static_cast<std::size_t>(t[(k + 2) % 3]);
          const Vec3 third = (points.positions[next] - points.positions[v])
                                 .cross(points.positions[after] - points.positions[v]) /
                             6.0;
          area += third.norm();
          if (!rides_[v] && air.colliders[v] == collider) {
            change -= pocket.side * motion_at(points.positions[v] - center).transpose() * third;
          }
        }
      }
      const double pressure = std::max(pocket.ambient + air.states[p].gauge, 0.1 * pocket.ambient);
      const double volume = std::max(air.states[p].volume, area * kThinAir);
      if (volume > 0.0) {
        stiffness += pressure / volume * change * change.transpose();
      }
    }
  }
  if (wrench.isZero(0)) {
    return false;
  }
  Block mobility;
  near.mobility(collider, mobility.data());
  const Twist shift =
      (Block::Identity() + h * h * mobility * stiffness).partialPivLu().solve(h * h * mobility * wrench);
  if (!shift.allFinite()) {
    return false;
  }
  const Twist impulse = h * (wrench - stiffness * shift);
  near.push(collider, impulse.head<3>(), center, impulse.tail<3>());
  for (const Rider& rider : riders_) {
    const auto v = static_cast<std::size_t>(rider.point);
    Vec3 by = motion_at(points.positions[v] - center) * shift;
    if (rider.slides) {
      by = rider.normal * rider.normal.dot(by);
    }
    points.positions[v] += by;
    points.velocities[v] += by / h;
  }
  return !riders_.empty();
}

void ColliderCoupling::push(NearColliders& near, double time, std::span<const int> colliders,
                            std::span<const Vec3> forces, std::span<const Vec3> points) {
  for (std::size_t v = 0; v < forces.size(); ++v) {
    const int collider = colliders[v];
    if (collider >= 0 && !near.collider(collider).movable && !forces[v].isZero(0)) {
      near.push(collider, time * forces[v], points[v]);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
