#include "collider_coupling.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI::cloth {

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

void ColliderCoupling::push(NearColliders& near, double h, std::span<const PointContacts> contacts,
                            const ClothSolver& solver, std::span<const Vec3> positions) {
  for (const int point : points_) {
    if (!solver.touching(point)) {
      continue;
    }
    const auto v = static_cast<std::size_t>(point);
    Vec3 parts[2];
    split(contacts[v], solver.contact_force(point), parts);
    for (int k = 0; k < contacts[v].count; ++k) {
      const int collider = contacts[v].planes[k].collider;
      if (near.collider(collider).movable && !parts[k].isZero(0)) {
        near.push(collider, -h * parts[k], positions[v]);
      }
    }
  }
}

void ColliderCoupling::push(NearColliders& near, double time, std::span<const int> colliders,
                            std::span<const Vec3> forces, std::span<const Vec3> points, bool movable) {
  for (std::size_t v = 0; v < forces.size(); ++v) {
    const int collider = colliders[v];
    if (collider >= 0 && near.collider(collider).movable == movable && !forces[v].isZero(0)) {
      near.push(collider, time * forces[v], points[v]);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
