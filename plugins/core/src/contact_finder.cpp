// Vertices of a deformable against placed shapes. Corners and edges: feature_contacts.cpp.
#include "contact_finder.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// First point of the segment from..to (shape frame) whose distance is `margin`, by conservative
// advancement: the distance to a convex set is convex along a line. Returns false when it stays outside.
bool entry_point(const ColliderShape& shape, const Vec3& from, const Vec3& to, double margin, Vec3& at,
                 SurfaceDistance& surface) {
  const double length = (to - from).norm();
  double t = 0.0;
  for (int i = 0; i < 32; ++i) {
    at = from + t * (to - from);
    surface = shape.distance(at);
    const double ahead = surface.distance - margin;
    if (ahead < 1e-4) {
      return true;
    }
    t += ahead / length;
    if (!(t < 1.0)) {
      return false;
    }
  }
  return true;
}

}  // namespace

void ContactFinder::find_vertices(int body_index, const Deformable& body, const ShapeInstance& instance,
                                  const RigidState& rigid, double margin, ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose start = rigid.start * instance.local;
  const Pose end = rigid.end * instance.local;
  const double reach = (1.0 + kSlackMargins) * margin;
  Contact identity;
  identity.body = body_index;
  identity.object = rigid.object;
  identity.child = instance.child;
  identity.kind = ContactKind::vertex;

  for (std::size_t v = 0; v < body.positions_.size(); ++v) {
    const Vec3 to = end.to_local(body.end_positions_[v]);
    const bool may_cross = [&] {
      return (to - start.to_local(body.positions_[v])).norm() > 0.5 * shape.thinnest;
    }();
    if (!may_cross && shape.beyond(to, reach)) {
      continue;
    }
    SurfaceDistance surface = shape.distance(to);
    double gap = surface.distance - margin;
    if (gap < -kTrustedDepth || may_cross) {
      const Vec3 from = start.to_local(body.positions_[v]);
      Vec3 at;
      SurfaceDistance entry = shape.distance(from);
      if (entry.distance > 0.0 && entry_point(shape, from, to, margin, at, entry)) {
        surface = entry;
        gap = entry.distance - margin + entry.normal.dot(to - at);
      }
    }
    if (gap > kSlackMargins * margin) {
      continue;
    }
    identity.skin_feature = static_cast<int>(v);
    Contact& contact = contacts.find_or_add(identity);
    const Vec3 normal = end.rotation * surface.normal;
    if (contact.met && contact.normal.dot(normal) < kSameSide && gap < 0.0) {
      continue;  // the other side of an edge is nearer now: stay with the side that was entered (see refresh)
    }
    contact.rigid = instance.rigid;
    contact.shape_index = instance.index;
    contact.count = 1;
    contact.points = {static_cast<int>(v), 0, 0};
    contact.weights = {1.0, 0.0, 0.0};
    contact.normal = normal;
    contact.gap = gap;
    contact.arm = body.impulse_points_[v] - rigid.start.origin;
    contact.rigid_point = rigid.end.to_local(body.end_positions_[v] - (gap + margin) * normal);
    contact.seen = contact.met = true;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
