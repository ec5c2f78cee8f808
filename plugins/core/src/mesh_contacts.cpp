// Vertices of a deformable against triangle meshes and height fields. Triangles have no inside: every vertex
// remembers on which side of the mesh it is while it is near.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_finder.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Farther (m) from the mesh a vertex forgets its side.
constexpr double kNear = 0.02;
// A vertex may touch this many triangles of different directions at once: the faces of a hollow corner.
constexpr int kTouches = 3;
// And has room for what several passes find.
constexpr int kSlots = 6;
// Normals with a higher cosine are those of one plane.
constexpr double kSamePlane = 0.98;
// Triangles whose normals have a higher cosine count as one face.
constexpr double kOneFace = 0.9;
// The cosine from which the skin tells on which side of a triangle its body is.
constexpr double kClear = 0.3;
// Nearest points whose offset has a lower cosine to the surface's normal lie on its rim.
constexpr double kRim = 0.3;

// The part of the way from..to after which it passes through the triangle, from either side; 2 where it does
// not.
double crossing(const ShapeFacet& facet, const Vec3& from, const Vec3& to) {
  const double before = facet.normal.dot(from) - facet.offset, after = facet.normal.dot(to) - facet.offset;
  if ((before < 0.0) == (after < 0.0)) {
    return 2.0;
  }
  const double time = before / (before - after);
  const Vec3 at = from + time * (to - from);
  const Vec3 w = nearest_weights(at, facet.a, facet.b, facet.c);
  constexpr double kOff = 1e-12;  // m^2
  return (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c - at).squaredNorm() <= kOff ? time : 2.0;
}

// The angle of a facet at the nearest point: at a corner its own, elsewhere as much as any.
double angle_at(const ShapeFacet& facet, const Vec3& weights) {
  constexpr double kCorner = 1.0 - 1e-9;
  const auto angle = [](const Vec3& at, const Vec3& b, const Vec3& c) {
    return std::acos(std::clamp((b - at).normalized().dot((c - at).normalized()), -1.0, 1.0));
  };
  return weights[0] > kCorner   ? angle(facet.a, facet.b, facet.c)
         : weights[1] > kCorner ? angle(facet.b, facet.c, facet.a)
         : weights[2] > kCorner ? angle(facet.c, facet.a, facet.b)
                                : 1.0;
}

// The nearest point of some facets.
struct NearestFacet {
  double distance = std::numeric_limits<double>::infinity();  // m
  Vec3 offset = Vec3::Zero();                                 // m, from it to the point
  Vec3 normal = Vec3::Zero();  // of the surface there, by the angles of the facets

  NearestFacet(const std::vector<ShapeFacet>& facets, const std::vector<int>& near, const Vec3& p) {
    double best = distance;
    for (const int f : near) {
      const ShapeFacet& facet = facets[static_cast<std::size_t>(f)];
      const Vec3 w = nearest_weights(p, facet.a, facet.b, facet.c);
      const Vec3 to_point = p - (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c);
      const double squared = to_point.squaredNorm();
      constexpr double kSame = 1e-15;  // m^2: the same edge or corner seen from another facet
      if (squared > best + kSame) {
        continue;
      }
      if (squared < best - kSame) {
        normal.setZero();
      }
      best = std::min(best, squared);
      offset = to_point;
      normal += angle_at(facet, w) * facet.normal;
    }
    normal.normalize();
    distance = std::sqrt(best);
  }
  signed char side() const { return offset.dot(normal) < 0.0 ? -1 : 1; }
  bool on_rim() const { return std::abs(offset.dot(normal)) < kRim * distance; }
};

}  // namespace

ContactFinder::MeshMemory& ContactFinder::mesh_memory(const btCollisionObject* object, int child) {
  const auto known = std::find_if(mesh_memories_.begin(), mesh_memories_.end(), [&](const MeshMemory& m) {
    return m.object == object && m.child == child;
  });
  MeshMemory& memory = known != mesh_memories_.end() ? *known : mesh_memories_.emplace_back();
  if (memory.substep != substep_) {
    // What was not looked at in the last substep was elsewhere, or is another object at the same place.
    memory.fresh = memory.object == nullptr || memory.substep != substep_ - 1;
    if (memory.fresh || memory.sides.size() != body_->positions_.size()) {
      memory.sides.assign(body_->positions_.size(), 0);
    }
    memory.object = object;
    memory.child = child;
    memory.substep = substep_;
  }
  return memory;
}

// The side of the mesh, front (1) or back (-1), a vertex on its way from..to belongs to.
signed char ContactFinder::side_of_mesh(const std::vector<ShapeFacet>& facets, const Vec3& from,
                                        const Vec3& to, const Vec3& skin_normal, bool fresh,
                                        signed char known) const {
  if (first_ && known != 0) {
    const NearestFacet start(facets, features_, from);
    if (start.distance > kNear || (start.distance > margin_ && start.on_rim())) {
      known = 0;  // far enough to have gone round
    }
  }
  if (known != 0) {
    return known;
  }
  // Where it comes from: before the first triangle on its way, or where it is.
  double first = 2.0, depth = 0.0;
  signed char side = 0;
  const ShapeFacet* met = nullptr;
  for (const int f : features_) {
    const ShapeFacet& facet = facets[static_cast<std::size_t>(f)];
    if (const double time = crossing(facet, from, to); time < first) {
      first = time;
      met = &facet;
    }
  }
  Vec3 normal;
  if (met != nullptr) {
    normal = met->normal;
    depth = normal.dot(from) - met->offset;
    side = depth < 0.0 ? -1 : 1;
  } else {
    const NearestFacet end(facets, features_, to);
    normal = end.normal;
    depth = end.distance;
    side = end.side();
  }
  // A body put there just now may lie across the mesh. Of what is behind it the skin tells whether it belongs
  // in front: fronts face outward in most meshes.
  const double facing = -normal.dot(skin_normal);
  if (fresh && side < 0 && std::abs(depth) < kNear && facing > kClear) {
    side = 1;
  }
  return side;
}

// What touches a vertex of the front (side 1) or back (-1) on its way from..to: what it crosses, what it is
// near, and the way out where it is on the wrong side.
void ContactFinder::touch_mesh(const std::vector<ShapeFacet>& facets, const Vec3& from, const Vec3& to,
                               double side, std::vector<MeshTouch>& touches) const {
  for (const int f : features_) {
    const ShapeFacet& facet = facets[static_cast<std::size_t>(f)];
    const double after = side * (facet.normal.dot(to) - facet.offset);
    MeshTouch touch;
    touch.normal = side * facet.normal;
    if (const double time = crossing(facet, from, to); time <= 1.0 && after < 0.0) {
      touch.gap = after - margin_;
      touch.distance = -after;
      touch.crossed_at = time;
      touch.interior = true;
      touches.push_back(touch);
      continue;
    }
    const Vec3 w = nearest_weights(to, facet.a, facet.b, facet.c);
    const Vec3 offset = to - (w[0] * facet.a + w[1] * facet.b + w[2] * facet.c);
    touch.distance = offset.norm();
    touch.interior = w.minCoeff() > 1e-9;
    if (touch.distance > reach_ || (after < 0.0 && !touch.interior)) {
      continue;
    }
    if (touch.interior) {
      touch.gap = after - margin_;
    } else {
      touch.gap = touch.distance - margin_;
      if (touch.distance > 1e-9) {
        touch.normal = offset / touch.distance;
      }
    }
    touches.push_back(touch);
  }
  const NearestFacet end(facets, features_, to);
  if (end.side() * side < 0.0 && !end.on_rim()) {
    MeshTouch out;
    out.normal = end.distance > 1e-9 ? Vec3(-end.offset / end.distance) : Vec3(side * end.normal);
    out.gap = -end.distance - margin_;
    out.distance = end.distance;
    out.way_out = true;
    touches.push_back(out);
  }
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
  MeshMemory& memory = mesh_memory(rigid.object, instance.child);
  for (std::size_t v = 0; v < body_->positions_.size(); ++v) {
    const Vec3 from = start.to_local(body_->positions_[v]), to = end.to_local(body_->end_positions_[v]);
    Bounds path = Bounds::of(to);
    path.include(from);
    touches_.clear();
    features_.clear();
    shape.facet_tree.in_region(path.grown(std::max(reach_, kNear)), [&](int f) { features_.push_back(f); });
    if (features_.empty()) {
      memory.sides[v] = 0;
      continue;
    }
    const Vec3 normal = end.rotation.transpose() * skin_.vertex_normal(static_cast<int>(v));
    signed char& side = memory.sides[v];
    side = side_of_mesh(shape.facets, from, to, normal, memory.fresh, side);
    touch_mesh(shape.facets, from, to, side, touches_);
    if (touches_.empty()) {
      continue;
    }
    // First what was crossed first, else the way out, else what is nearest; beside it only what is touched
    // within its own triangle from another direction, as in a hollow. Faces that the vertex is deep behind
    // wait for the next pass: on a ridge the nearest one is the way out.
    const auto before = [](const MeshTouch& a, const MeshTouch& b) {
      return a.crossed_at != b.crossed_at ? a.crossed_at < b.crossed_at
             : a.way_out != b.way_out     ? a.way_out
                                          : a.distance < b.distance;
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
      // Else one that is empty, before one that only this pass has not yet found again: what an earlier pass
      // found has to stay.
      int slot = -1, empty_slot = -1, unseen_slot = -1;
      for (int k = kSlots - 1; k >= 0; --k) {
        name.skin_feature = static_cast<int>(v);
        name.rigid_feature = k;
        const Contact* known = contacts.find(name);
        if (known == nullptr) {
          empty_slot = k;
        } else if (!known->seen) {
          const double same = known->met ? kSamePlane : kSameSide;
          (known->normal.dot(world) > same ? slot : unseen_slot) = k;
        }
      }
      if (slot < 0) {
        slot = empty_slot >= 0 ? empty_slot : unseen_slot;
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
