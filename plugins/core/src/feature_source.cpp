#include "feature_source.h"

#include <algorithm>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Edges of thin shapes and skins are trusted no deeper than this (m).
constexpr double kDeepestEdge = 5e-3;

// The bounds of a box (world) in the frame of `pose`.
Bounds to_local(const Pose& pose, const Bounds& box) {
  const Vec3 middle = pose.to_local(0.5 * (box.low + box.high));
  const Vec3 half = pose.rotation.transpose().cwiseAbs() * (0.5 * (box.high - box.low));
  return {middle - half, middle + half};
}

}  // namespace

RigidFeatures::RigidFeatures(const ShapeInstance& instance, const RigidState& rigid)
    : instance_(instance),
      shape_(*instance.collider),
      rigid_(rigid),
      start_(rigid.start * instance.local),
      end_(rigid.end * instance.local) {}

void RigidFeatures::corners_in(const Bounds& region, std::vector<int>& out) const {
  out.clear();
  shape_.corner_tree.in_region(to_local(end_, region), [&](int i) { out.push_back(i); });
  std::sort(out.begin(), out.end());
}

void RigidFeatures::edges_in(const Bounds& region, std::vector<int>& out) const {
  out.clear();
  shape_.edge_tree.in_region(to_local(end_, region), [&](int i) { out.push_back(i); });
  std::sort(out.begin(), out.end());
}

FeatureSource::Corner RigidFeatures::corner(int index) const {
  const Vec3& local = shape_.corners[static_cast<std::size_t>(index)];
  return {start_.to_world(local), end_.to_world(local)};
}

FeatureSource::Edge RigidFeatures::edge(int index, bool at_start) const {
  const ShapeEdge& local = shape_.edges[static_cast<std::size_t>(index)];
  const Pose& pose = at_start ? start_ : end_;
  return {pose.to_world(local.a), pose.to_world(local.b), pose.rotation * local.into_first,
          pose.rotation * local.into_second};
}

// Against the skin's normal, but within the cone of directions in which the corner is foremost.
Vec3 RigidFeatures::press_direction(int corner, const Vec3& skin_normal, const Vec3& outward) const {
  const std::span<const Vec3> edges = shape_.edges_of_corner(corner);
  Vec3 direction = -(end_.rotation.transpose() * skin_normal).normalized();
  for (int round = 0; round < 3; ++round) {
    for (const Vec3& edge : edges) {
      direction -= std::max(direction.dot(edge), 0.0) * edge;
    }
  }
  const double length = direction.norm();
  const bool mesh = shape_.kind == ColliderShape::Kind::mesh;
  if (!(length > 1e-6)) {
    return mesh ? Vec3(Vec3::Zero()) : Vec3(-outward);
  }
  direction /= length;
  constexpr double kHollow = 0.1;  // sine
  if (mesh && std::any_of(edges.begin(), edges.end(),
                          [&](const Vec3& edge) { return direction.dot(edge) > kHollow; })) {
    return Vec3::Zero();
  }
  return end_.rotation * direction;
}

double RigidFeatures::deepest_edge() const { return std::min(kDeepestEdge, 0.25 * shape_.thinnest); }

void RigidFeatures::identify(Contact& contact) const {
  contact.object = rigid_.object;
  contact.child = instance_.child;
}

void RigidFeatures::place_corner(int corner, Contact& contact) const {
  contact.rigid = instance_.rigid;
  contact.shape_index = instance_.index;
  contact.other_body = -1;
  contact.rigid_point = rigid_.end.to_local(end_.to_world(shape_.corners[static_cast<std::size_t>(corner)]));
}

void RigidFeatures::place_edge(int, double, const Vec3& at_end, Contact& contact) const {
  contact.rigid = instance_.rigid;
  contact.shape_index = instance_.index;
  contact.other_body = -1;
  contact.rigid_point = rigid_.end.to_local(at_end);
}

void SkinFeatures::corners_in(const Bounds& region, std::vector<int>& out) const {
  out.clear();
  const std::vector<Vec3>& points = skin_.end();
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!region.misses(Bounds::of(points[v]))) {
      out.push_back(static_cast<int>(v));
    }
  }
}

void SkinFeatures::edges_in(const Bounds& region, std::vector<int>& out) const {
  out.clear();
  skin_.edges().in_region(region, [&](int i) { out.push_back(i); });
  std::sort(out.begin(), out.end());
}

FeatureSource::Corner SkinFeatures::corner(int index) const {
  return {skin_.start()[static_cast<std::size_t>(index)], skin_.end()[static_cast<std::size_t>(index)]};
}

FeatureSource::Edge SkinFeatures::edge(int index, bool at_start) const {
  const auto e = static_cast<std::size_t>(index);
  const std::vector<Vec3>& points = at_start ? skin_.start() : skin_.end();
  Edge edge;
  edge.a = points[static_cast<std::size_t>(skin_.edge_vertices()[e][0])];
  edge.b = points[static_cast<std::size_t>(skin_.edge_vertices()[e][1])];
  const Vec3 along = (edge.b - edge.a).normalized();
  // Edges run along their first face, against the second.
  edge.into_first = skin_.face_normal(skin_.edge_faces()[e][0], at_start).cross(along);
  edge.into_second = skin_.edge_faces()[e][1] >= 0
                         ? Vec3(along.cross(skin_.face_normal(skin_.edge_faces()[e][1], at_start)))
                         : Vec3(Vec3::Zero());
  return edge;
}

// Half way between the two smooth normals.
Vec3 SkinFeatures::press_direction(int corner, const Vec3& skin_normal, const Vec3& outward) const {
  const Vec3 direction = skin_.vertex_normal(corner).normalized() - skin_normal.normalized();
  const double length = direction.norm();
  return length > 0.2 ? Vec3(direction / length) : Vec3(-outward);
}

double SkinFeatures::deepest_edge() const { return std::min(kDeepestEdge, 0.05 * skin_.size().minCoeff()); }

void SkinFeatures::identify(Contact& contact) const {
  contact.object = &skin_.body();
  contact.child = 0;
}

void SkinFeatures::place_corner(int corner, Contact& contact) const {
  contact.rigid = rigid_;
  contact.shape_index = shape_index_;
  contact.other_body = body_index_;
  contact.other_count = 1;
  contact.other_points = {corner, 0, 0};
  contact.other_weights = {1.0, 0.0, 0.0};
}

void SkinFeatures::place_edge(int edge, double along, const Vec3&, Contact& contact) const {
  const auto& vertices = skin_.edge_vertices()[static_cast<std::size_t>(edge)];
  contact.rigid = rigid_;
  contact.shape_index = shape_index_;
  contact.other_body = body_index_;
  contact.other_count = 2;
  contact.other_points = {vertices[0], vertices[1], 0};
  contact.other_weights = {1.0 - along, along, 0.0};
}

}  // namespace softpoint::inline SOFTPOINT_ABI
