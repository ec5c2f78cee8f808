// Edges of boxes against the edges of a deformable.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Edge pairs nearly parallel have no common normal worth using; their ends make vertex contacts.
constexpr double kParallelSine = 0.05;
// Slack (as a sine) in the test that a normal lies between the two faces of an edge.
constexpr double kWedgeSlack = 0.05;

// Parameters of the mutually nearest points of the lines a + s u and b + t v; false when nearly parallel.
bool nearest_on_lines(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v, double& s, double& t) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (determinant <= kParallelSine * kParallelSine * uu * vv) {
    return false;
  }
  const Vec3 w = b - a;
  s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
  t = (uv * u.dot(w) - uu * v.dot(w)) / determinant;
  return true;
}

}  // namespace

// The common normal of an edge of a shape (placed at `pose`) and an edge of the skin with its vertices at
// `points`; false when they are nearly parallel, or when features other than the two edges are nearest: the
// normal has to lie between the two faces on either side.
bool ContactFinder::measure_edges(const Deformable& body, const std::vector<Vec3>& points,
                                  const ShapeEdge& edge, const Pose& pose, int skin_edge,
                                  EdgePair& pair) const {
  const auto e = static_cast<std::size_t>(skin_edge);
  const Vec3 a = pose.to_world(edge.a), u = pose.rotation * (edge.b - edge.a);
  const Vec3& p = points[static_cast<std::size_t>(body.edges_[e][0])];
  const Vec3 v = points[static_cast<std::size_t>(body.edges_[e][1])] - p;
  if (!nearest_on_lines(a, u, p, v, pair.s, pair.t)) {
    return false;
  }
  constexpr double kEnd = 1e-6;  // ends belong to corners and vertices
  if (pair.s < kEnd || pair.s > 1 - kEnd || pair.t < kEnd || pair.t > 1 - kEnd) {
    return false;
  }
  const Vec3 m1 = face_normal(body, points, body.edge_faces_[e][0]);
  const Vec3 m2 = body.edge_faces_[e][1] >= 0 ? face_normal(body, points, body.edge_faces_[e][1]) : m1;
  pair.normal = u.cross(v).normalized();
  if (pair.normal.dot(m1 + m2) > 0.0) {
    pair.normal = -pair.normal;  // from the collider into the skin
  }
  // Directions from the skin's edge into its two faces; edges_ run along the first face.
  const Vec3 along = v.normalized();
  if (-pair.normal.dot(m1.cross(along)) > kWedgeSlack || -pair.normal.dot(along.cross(m2)) > kWedgeSlack) {
    return false;  // a face or a hollow edge of the skin is nearer
  }
  if (pair.normal.dot(pose.rotation * edge.into_first) > kWedgeSlack ||
      pair.normal.dot(pose.rotation * edge.into_second) > kWedgeSlack) {
    return false;  // a face of the collider is nearer
  }
  pair.gap = pair.normal.dot((p + pair.t * v) - (a + pair.s * u));
  return true;
}

void ContactFinder::find_edges(int body_index, const Deformable& body, const ShapeInstance& instance,
                               const RigidState& rigid, double margin, bool at_start,
                               ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose end = rigid.end * instance.local;
  const Pose start = rigid.start * instance.local;
  const double reach = (1.0 + kSlackMargins) * margin;
  // Pairs that lie deeper than this without having come from outside are not what touches first.
  const double deepest = std::min(kTrustedDepth, 0.25 * shape.thinnest);
  // Over a step the pair may have moved as far as the colliders' bounds say.
  const double travel = at_start ? step_travel_ + (end.origin - start.origin).norm() : 0.0;
  Contact identity;
  identity.body = body_index;
  identity.object = rigid.object;
  identity.child = instance.child;
  identity.kind = ContactKind::edge;
  for (std::size_t i = 0; i < shape.edges.size(); ++i) {
    const ShapeEdge& edge = shape.edges[i];
    const Vec3 a = end.to_world(edge.a), b = end.to_world(edge.b);
    const Vec3 low = a.cwiseMin(b).array() - (reach + deepest + travel);
    const Vec3 high = a.cwiseMax(b).array() + (reach + deepest + travel);
    if (body_bounds_.misses(low, high, 0.0)) {
      continue;
    }
    for (std::size_t e = 0; e < body.edges_.size(); ++e) {
      const auto v0 = static_cast<std::size_t>(body.edges_[e][0]),
                 v1 = static_cast<std::size_t>(body.edges_[e][1]);
      const Vec3& p = body.end_positions_[v0];
      const Vec3& q = body.end_positions_[v1];
      if ((p.cwiseMin(q) - high).maxCoeff() > 0.0 || (low - p.cwiseMax(q)).maxCoeff() > 0.0) {
        continue;
      }
      const int skin_edge = static_cast<int>(e);
      EdgePair pair;
      double gap = 0;
      const bool apart =
          at_start && measure_edges(body, body.positions_, edge, start, skin_edge, pair) && pair.gap > 0.0;
      if (apart) {
        // Follow the two points that are nearest now to the end of the step.
        gap = pair.normal.dot(p + pair.t * (q - p) - (a + pair.s * (b - a))) - margin;
      } else {
        if (!measure_edges(body, body.end_positions_, edge, end, skin_edge, pair)) {
          continue;
        }
        gap = pair.gap - margin;
        if (gap < -deepest) {
          continue;
        }
      }
      if (gap > kSlackMargins * margin) {
        continue;
      }
      identity.rigid_feature = static_cast<int>(i);
      identity.skin_feature = skin_edge;
      Contact& contact = contacts.find_or_add(identity);
      contact.rigid = instance.rigid;
      contact.shape_index = instance.index;
      contact.count = 2;
      contact.points = {body.edges_[e][0], body.edges_[e][1], 0};
      contact.weights = {1.0 - pair.t, pair.t, 0.0};
      contact.normal = pair.normal;
      contact.gap = gap;
      contact.arm =
          (1.0 - pair.t) * body.impulse_points_[v0] + pair.t * body.impulse_points_[v1] - rigid.start.origin;
      contact.rigid_point = rigid.end.to_local(a + pair.s * (b - a));
      contact.seen = contact.met = true;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
