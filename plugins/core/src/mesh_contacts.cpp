// Vertices of a deformable against triangle meshes and height fields. Triangles have no inside: the side a
// vertex belongs to is that of the skin behind it.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// A vertex this far (m) on the wrong side of a triangle is still brought back.
constexpr double kDeepest = 0.02;
// A vertex may touch this many triangles of different directions at once: the faces of a hollow corner.
constexpr int kTouches = 3;
// Triangles whose normals have a higher cosine count as one face.
constexpr double kOneFace = 0.9;

}  // namespace

// What one triangle has to say about a vertex on its way from..to (shape frame).
void ContactFinder::touch_triangle(const ShapeFacet& facet, const Vec3& from, const Vec3& to,
                                   const Vec3& skin_normal, std::vector<MeshTouch>& touches) const {
  const double before = facet.normal.dot(from) - facet.offset, after = facet.normal.dot(to) - facet.offset;
  // Near the plane the skin knows best on which side its body is; far from it, where the vertex came from.
  const double facing = -facet.normal.dot(skin_normal);
  constexpr double kClear = 0.3;
  const bool trust_skin = std::abs(before) < kDeepest && std::abs(facing) > kClear;
  const double side = (trust_skin ? facing : before) < 0.0 ? -1.0 : 1.0;
  MeshTouch touch;
  touch.normal = side * facet.normal;
  if (side * before >= 0.0 && side * after < 0.0) {
    const Vec3 at = from + before / (before - after) * (to - from);
    const Vec3 w = nearest_weights(at, facet.a, facet.b, facet.c);
    const double off = (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c - at).squaredNorm();
    if (off <= 1e-12) {
      touch.gap = side * after - margin_;
      touch.distance = std::abs(after);
      touch.crossed_at = before / (before - after);
      touch.interior = true;
      touches.push_back(touch);
      return;
    }
  }
  const Vec3 w = nearest_weights(to, facet.a, facet.b, facet.c);
  const Vec3 offset = to - (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c);
  const double length = offset.norm();
  if (length > (side * after < 0.0 ? kDeepest : reach_)) {
    return;
  }
  touch.distance = length;
  touch.interior = w.minCoeff() > 1e-9;
  if (touch.interior) {
    touch.gap = side * after - margin_;
  } else if (side * after > 0.0 || length < 1e-9) {
    touch.gap = length - margin_;
    if (length > 1e-9) {
      touch.normal = offset / length;
    }
  } else {
    return;  // behind the plane but beside the triangle
  }
  touches.push_back(touch);
}

void ContactFinder::find_vertices_on_mesh(const ShapeInstance& instance, const RigidState& rigid,
                                          ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  if (shape.facets.empty()) {
    return;
  }
  skin();
  const Pose start = rigid.start * instance.local;
  const Pose end = rigid.end * instance.local;
  Contact name = identity(instance, rigid, ContactKind::vertex);
  for (std::size_t v = 0; v < body_->positions_.size(); ++v) {
    const Vec3 from = start.to_local(body_->positions_[v]), to = end.to_local(body_->end_positions_[v]);
    Bounds path = Bounds::of(to);
    path.include(from);
    touches_.clear();
    const Vec3 normal = end.rotation.transpose() * skin_.vertex_normal(static_cast<int>(v));
    shape.facet_tree.in_region(path.grown(std::max(reach_, kDeepest)), [&](int f) {
      touch_triangle(shape.facets[static_cast<std::size_t>(f)], from, to, normal, touches_);
    });
    if (touches_.empty()) {
      continue;
    }
    // First what was crossed first, else what is nearest; beside it only what is touched within its own
    // triangle from another direction, as in a hollow. Faces that the vertex is deep behind wait for the next
    // pass: on a ridge the nearest one is the way out.
    const auto before = [](const MeshTouch& a, const MeshTouch& b) {
      return a.crossed_at != b.crossed_at ? a.crossed_at < b.crossed_at : a.distance < b.distance;
    };
    std::swap(*std::min_element(touches_.begin(), touches_.end(), before), touches_.front());
    int taken = 0;
    for (std::size_t i = 0; i < touches_.size() && taken < kTouches; ++i) {
      const MeshTouch& touch = touches_[i];
      const bool another =
          std::none_of(touches_.begin(), touches_.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const MeshTouch& t) { return t.normal.dot(touch.normal) > kOneFace; });
      if (touch.gap > kSlackMargins * margin_ ||
          (i > 0 && !(touch.interior && another && touch.gap > -2.0 * margin_))) {
        continue;
      }
      // The slot whose last contact had this direction, so that a sliding vertex keeps its impulse.
      const Vec3 world = end.rotation * touch.normal;
      int slot = -1, free_slot = -1;
      for (int k = kTouches - 1; k >= 0; --k) {
        name.skin_feature = static_cast<int>(v);
        name.rigid_feature = k;
        const Contact* known = contacts.find(name);
        if (known == nullptr || !known->seen) {
          free_slot = k;
        }
        if (known != nullptr && !known->seen && known->normal.dot(world) > kSameSide) {
          slot = k;
        }
      }
      if (slot < 0) {
        slot = free_slot;
      }
      if (slot < 0) {
        break;
      }
      name.skin_feature = static_cast<int>(v);
      name.rigid_feature = slot;
      Contact& contact = contacts.find_or_add(name);
      contact.normal = world;
      contact.gap = touch.gap;
      place_on_vertex(static_cast<int>(v), instance, rigid, contact);
      ++taken;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
