// Vertices of a deformable against placed shapes. Meshes: mesh_contacts.cpp; corners: corner_contacts.cpp;
// edges: edge_contacts.cpp; round shapes: face_contacts.cpp.
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

void ContactFinder::begin_pass(int body_index, const Deformable& body, double margin, bool first) {
  if (body_ != &body) {
    mesh_memories_.clear();
  }
  body_index_ = body_index;
  body_ = &body;
  substep_ += first;
  margin_ = margin;
  reach_ = (1.0 + kSlackMargins) * margin;
  first_ = first;
  skin_.expire();
}

const Skin& ContactFinder::skin() {
  skin_.update(*body_);
  return skin_;
}

Contact ContactFinder::identity(const ShapeInstance& shape, const RigidState& rigid, ContactKind kind) const {
  Contact contact;
  contact.body = body_index_;
  contact.object = rigid.object;
  contact.child = shape.child;
  contact.kind = kind;
  return contact;
}

void ContactFinder::find_vertices(const ShapeInstance& instance, const RigidState& rigid,
                                  ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose start = rigid.start * instance.local;
  const Pose end = rigid.end * instance.local;
  Contact name = identity(instance, rigid, ContactKind::vertex);

  for (std::size_t v = 0; v < body_->positions_.size(); ++v) {
    const Vec3 to = end.to_local(body_->end_positions_[v]);
    const bool may_cross = [&] {
      return (to - start.to_local(body_->positions_[v])).norm() > 0.5 * shape.thinnest;
    }();
    if (!may_cross && shape.beyond(to, reach_)) {
      continue;
    }
    SurfaceDistance surface = shape.distance(to);
    double gap = surface.distance - margin_;
    if (gap < -kTrustedDepth || may_cross) {
      const Vec3 from = start.to_local(body_->positions_[v]);
      Vec3 at;
      SurfaceDistance entry = shape.distance(from);
      if (entry.distance > 0.0 && entry_point(shape, from, to, margin_, at, entry)) {
        surface = entry;
        gap = entry.distance - margin_ + entry.normal.dot(to - at);
      }
    }
    if (gap > kSlackMargins * margin_) {
      continue;
    }
    name.skin_feature = static_cast<int>(v);
    Contact& contact = contacts.find_or_add(name);
    const Vec3 normal = end.rotation * surface.normal;
    if (contact.met && contact.normal.dot(normal) < kSameSide && gap < 0.0) {
      continue;  // the other side of an edge is nearer now: stay with the side that was entered
    }
    contact.normal = normal;
    contact.gap = gap;
    place_on_vertex(static_cast<int>(v), instance, rigid, contact);
  }
}

void ContactFinder::place_on_vertex(int vertex, const ShapeInstance& instance, const RigidState& rigid,
                                    Contact& contact) const {
  const auto v = static_cast<std::size_t>(vertex);
  contact.rigid = instance.rigid;
  contact.shape_index = instance.index;
  contact.count = 1;
  contact.points = {vertex, 0, 0};
  contact.weights = {1.0, 0.0, 0.0};
  contact.arm = body_->impulse_points_[v] - rigid.start.origin;
  contact.rigid_point =
      rigid.end.to_local(body_->end_positions_[v] - (contact.gap + margin_) * contact.normal);
  contact.seen = contact.met = true;
}

void ContactFinder::place_on_face(int face, const Vec3& weights, const RigidState& rigid,
                                  Contact& contact) const {
  contact.count = 3;
  Vec3 at_start = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    contact.points[k] = body_->triangles_[static_cast<std::size_t>(face)][k];
    contact.weights[k] = weights[static_cast<Eigen::Index>(k)];
    at_start += contact.weights[k] * body_->impulse_points_[static_cast<std::size_t>(contact.points[k])];
  }
  contact.arm = at_start - rigid.start.origin;
}

Vec3 ContactFinder::skin_point(const Contact& contact) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < static_cast<std::size_t>(contact.count); ++k) {
    sum += contact.weights[k] * body_->end_positions_[static_cast<std::size_t>(contact.points[k])];
  }
  return sum;
}

void ContactFinder::refresh_on_plane(const Vec3& other_point, Contact& contact) const {
  contact.gap = contact.normal.dot(skin_point(contact) - other_point) - margin_;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
