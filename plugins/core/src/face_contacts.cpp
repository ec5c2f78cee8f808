// Round and other convex shapes against the faces of a deformable.
#include <algorithm>

#include "contact_finder.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// A face has a contact point in each cell of a grid of barycentric weights that was nearest to the shape.
int zone(const Vec3& weights) {
  constexpr int kCells = 6;
  const auto cell = [](double weight) { return std::min(static_cast<int>(kCells * weight), kCells - 1); };
  return kCells * cell(weights[0]) + cell(weights[1]);
}

}  // namespace

// The skin sinks in between its vertices when it wraps round a shape, so every near face makes a contact of
// its own, at the end of the shortest line from the shape's core. Faces that the core has already passed are
// taken as they stand at the start of the step.
void ContactFinder::find_faces(const ShapeInstance& instance, const RigidState& rigid,
                               ContactTable& contacts) {
  skin();
  const ColliderShape& shape = *instance.collider;
  const Pose end = rigid.end * instance.local;
  const Pose start = rigid.start * instance.local;
  const double radius = shape.core_radius();
  const double travel = first_ ? skin_.travel() + (end.origin - start.origin).norm() : 0.0;
  const Vec3 middle = end.to_world(0.5 * (shape.bounds_min + shape.bounds_max));
  const Vec3 half = end.rotation.cwiseAbs() * (0.5 * (shape.bounds_max - shape.bounds_min));
  const Bounds region = Bounds{middle - half, middle + half}.grown(reach_ + travel);
  features_.clear();
  skin_.faces().in_region(region, [&](int f) { features_.push_back(f); });
  std::sort(features_.begin(), features_.end());
  Contact name = identity(instance, rigid, ContactKind::face);
  for (const int f : features_) {
    const Triangle& t = skin_.triangle(f);
    const auto measure = [&](const std::vector<Vec3>& points, const Pose& pose,
                             ColliderShape::CoreDistance& line, Vec3& weights, Vec3& normal) {
      Vec3 local[3];
      for (std::size_t k = 0; k < 3; ++k) {
        local[k] = pose.to_local(points[static_cast<std::size_t>(t[k])]);
      }
      const Vec3 outward = (local[1] - local[0]).cross(local[2] - local[0]);
      if (!shape.core_distance(local[0], local[1], local[2], line)) {
        return false;
      }
      normal = (line.on_triangle - line.on_core) / line.distance;
      weights = nearest_weights(line.on_triangle, local[0], local[1], local[2]);
      // Not from behind, and not at a vertex, which makes a contact of its own.
      return normal.dot(outward) < 0.0 && weights.maxCoeff() < 1.0 - 1e-9;
    };
    ColliderShape::CoreDistance line;
    Vec3 weights, normal;
    double gap = 0;
    if (measure(body_->end_positions_, end, line, weights, normal)) {
      const SurfaceDistance surface = shape.distance(line.on_triangle);  // GJK's own figure is a rough one
      gap = surface.distance - margin_;
      normal = end.rotation * surface.normal;
    } else if (first_ && measure(body_->positions_, start, line, weights, normal)) {
      normal = start.rotation * normal;
      Vec3 skin = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        skin += weights[static_cast<Eigen::Index>(k)] * body_->end_positions_[static_cast<std::size_t>(t[k])];
      }
      gap = normal.dot(skin - end.to_world(line.on_core)) - radius - margin_;
    } else if (!sample_face(t, shape, end, weights, normal, gap)) {
      continue;
    } else {
      gap -= margin_;
    }
    if (gap > kSlackMargins * margin_) {
      continue;
    }
    Vec3 skin = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      skin += weights[static_cast<Eigen::Index>(k)] * body_->end_positions_[static_cast<std::size_t>(t[k])];
    }
    name.skin_feature = f;
    if (!free_slot(zone(weights), skin, gap, name, contacts)) {
      continue;
    }
    Contact& contact = contacts.find_or_add(name);
    contact.rigid = instance.rigid;
    contact.shape_index = instance.index;
    contact.normal = normal;
    contact.gap = gap;
    contact.rigid_point = rigid.end.to_local(skin - (gap + margin_) * normal);
    place_on_face(f, weights, rigid, contact);
    contact.seen = contact.met = true;
  }
}

// Points that pressed in an earlier pass of this substep stay (see refresh_face); one that is found beside
// them joins them, so that what a pass separates does not fall back in the next. In the first pass the
// nearest point takes over from that of the last substep, so that what slides or rolls is pressed where it is
// now.
bool ContactFinder::free_slot(int zone, const Vec3& point, double gap, Contact& name,
                              ContactTable& contacts) const {
  constexpr int kSlots = 4, kZones = 36;
  constexpr double kBeside = 1e-3;  // m
  for (int slot = 0; slot < kSlots; ++slot) {
    name.rigid_feature = zone + kZones * slot;
    const Contact* known = contacts.find(name);
    if (known == nullptr || !known->met) {
      return slot == 0 || gap < 0.0;
    }
    if ((skin_point(*known) - point).squaredNorm() < kBeside * kBeside) {
      return false;
    }
  }
  return false;
}

// Where the core of a shape has got into a face: the deepest of ten points spread over it.
bool ContactFinder::sample_face(const Triangle& t, const ColliderShape& shape, const Pose& pose,
                                Vec3& weights, Vec3& normal, double& distance) const {
  distance = 0.0;
  for (int i = 0; i <= 3; ++i) {
    for (int j = 0; j <= 3 - i; ++j) {
      const Vec3 w(i / 3.0, j / 3.0, (3 - i - j) / 3.0);
      if (w.maxCoeff() == 1.0) {
        continue;  // vertices make contacts of their own
      }
      Vec3 point = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        point += w[static_cast<Eigen::Index>(k)] * body_->end_positions_[static_cast<std::size_t>(t[k])];
      }
      const SurfaceDistance surface = shape.distance(pose.to_local(point));
      if (surface.distance < distance) {
        distance = surface.distance;
        weights = w;
        normal = pose.rotation * surface.normal;
      }
    }
  }
  return distance < 0.0;
}

// A point of a face, once it has touched, is a point of the material: measured like a vertex.
bool ContactFinder::refresh_face(const ShapeInstance& instance, const RigidState& rigid,
                                 Contact& contact) const {
  const Pose end = rigid.end * instance.local;
  const Vec3 point = skin_point(contact);
  const Vec3 weights(contact.weights[0], contact.weights[1], contact.weights[2]);
  const SurfaceDistance surface = instance.collider->distance(end.to_local(point));
  const Vec3 normal = end.rotation * surface.normal;
  const double gap = surface.distance - margin_;
  if (contact.met && gap < 0.0 && contact.normal.dot(normal) < kSameSide) {
    // The other side of the shape is nearer now: stay on the plane it had.
    contact.gap = contact.normal.dot(point - rigid.end.to_world(contact.rigid_point)) - margin_;
  } else {
    contact.normal = normal;
    contact.gap = gap;
    contact.rigid_point = rigid.end.to_local(point - surface.distance * normal);
  }
  contact.rigid = instance.rigid;
  place_on_face(contact.skin_feature, weights, rigid, contact);
  return true;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
