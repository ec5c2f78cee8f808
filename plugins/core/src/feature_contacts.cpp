// Corners and edges of rigid shapes against the faces and edges of a deformable.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

constexpr double kSlackMargins = 3.0;
// A corner that moved less than this into the skin keeps its nearest face; beyond it the path decides.
constexpr double kTrustedDepth = 5e-3;
// Edge pairs nearly parallel have no common normal worth using; their ends make vertex contacts.
constexpr double kParallelSine = 0.05;
// Slack (as a sine) in the test that a normal lies between the two faces of an edge.
constexpr double kWedgeSlack = 0.05;

// Barycentric weights of the point of triangle a, b, c nearest to p (Ericson's region walk).
Vec3 nearest_weights(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 / (d1 - d3);
    return {1 - t, t, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 / (d2 - d6);
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

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

Vec3 ContactFinder::face_normal(const Deformable& body, int face) const {
  const Triangle& t = body.triangles_[static_cast<std::size_t>(face)];
  const auto at = [&](int i) -> const Vec3& { return body.end_positions_[static_cast<std::size_t>(i)]; };
  return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
}

void ContactFinder::begin_pass(const Deformable& body) {
  face_bounds_.resize(body.triangles_.size());
  body_bounds_.low = body_bounds_.high = body.end_positions_.front();
  for (const Vec3& p : body.end_positions_) {
    body_bounds_.low = body_bounds_.low.cwiseMin(p);
    body_bounds_.high = body_bounds_.high.cwiseMax(p);
  }
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    const Triangle& t = body.triangles_[f];
    const auto at = [&](int k) -> const Vec3& {
      return body.end_positions_[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    face_bounds_[f] = {at(0).cwiseMin(at(1)).cwiseMin(at(2)), at(0).cwiseMax(at(1)).cwiseMax(at(2))};
  }
}

// First face that the segment enters from outside.
bool ContactFinder::crossed_face(const Deformable& body, const Vec3& from, const Vec3& to,
                                 SkinPoint& hit) const {
  const Vec3 d = to - from;
  double first = 1.0 + 1e-9;
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    if (face_bounds_[f].misses(from, to, 0.0)) {
      continue;
    }
    const Triangle& t = body.triangles_[f];
    const Vec3& a = body.end_positions_[static_cast<std::size_t>(t[0])];
    const Vec3 e1 = body.end_positions_[static_cast<std::size_t>(t[1])] - a;
    const Vec3 e2 = body.end_positions_[static_cast<std::size_t>(t[2])] - a;
    // Moller-Trumbore, front faces only.
    const Vec3 q = d.cross(e2);
    const double determinant = e1.dot(q);
    if (determinant <= 0.0) {
      continue;
    }
    const Vec3 s = from - a;
    const double u = s.dot(q);
    const Vec3 r = s.cross(e1);
    const double v = d.dot(r);
    const double time = e2.dot(r);
    if (u < 0.0 || v < 0.0 || u + v > determinant || time < 0.0 || time >= first * determinant) {
      continue;
    }
    first = time / determinant;
    hit.face = static_cast<int>(f);
    hit.weights = {1.0 - (u + v) / determinant, u / determinant, v / determinant};
  }
  if (hit.face < 0) {
    return false;
  }
  hit.outward = face_normal(body, hit.face);
  hit.distance = hit.outward.dot(to - (from + first * d));
  return true;
}

// Nearest point of the skin with its signed distance; false beyond `reach` or where a vertex is nearest
// (vertices make contacts of their own).
bool ContactFinder::nearest_face(const Deformable& body, const Vec3& p, double reach, SkinPoint& nearest) const {
  double best = reach * reach;
  Vec3 at = Vec3::Zero();
  Vec3 side = Vec3::Zero();
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    if (face_bounds_[f].misses(p, p, reach)) {
      continue;
    }
    const Triangle& t = body.triangles_[f];
    const Vec3& a = body.end_positions_[static_cast<std::size_t>(t[0])];
    const Vec3& b = body.end_positions_[static_cast<std::size_t>(t[1])];
    const Vec3& c = body.end_positions_[static_cast<std::size_t>(t[2])];
    const Vec3 w = nearest_weights(p, a, b, c);
    const Vec3 q = w[0] * a + w[1] * b + w[2] * c;
    const double squared = (p - q).squaredNorm();
    constexpr double kSame = 1e-18;  // m^2: the same edge seen from its other face
    if (squared > best + kSame) {
      continue;
    }
    const Vec3 normal = face_normal(body, static_cast<int>(f));
    if (nearest.face >= 0 && squared > best - kSame) {
      side += normal;
      continue;
    }
    best = squared;
    nearest.face = static_cast<int>(f);
    nearest.weights = w;
    at = q;
    side = normal;
  }
  if (nearest.face < 0 || nearest.weights.maxCoeff() > 1.0 - 1e-9) {
    return false;
  }
  side.normalize();
  const double length = std::sqrt(best);
  const double sign = (p - at).dot(side) < 0.0 ? -1.0 : 1.0;
  nearest.distance = sign * length;
  nearest.outward = length > 1e-9 ? Vec3(sign * (p - at) / length) : side;
  return true;
}

void ContactFinder::find_corners(int body_index, const Deformable& body, const ShapeInstance& instance,
                                 const RigidState& rigid, double margin, ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose start = rigid.start * instance.local;
  const Pose end = rigid.end * instance.local;
  const double radius = shape.feature_radius;
  const Vec3 size = body_bounds_.high - body_bounds_.low;
  const double reach = radius + std::max(0.02, 0.1 * size.maxCoeff());
  // Motion of the body as a whole, so that the path of a corner is seen from the body.
  Vec3 drift = Vec3::Zero();
  for (std::size_t v = 0; v < body.positions_.size(); ++v) {
    drift += body.end_positions_[v] - body.positions_[v];
  }
  drift /= static_cast<double>(body.positions_.size());

  Contact identity;
  identity.body = body_index;
  identity.object = rigid.object;
  identity.shape = instance.shape;
  identity.kind = ContactKind::corner;
  for (std::size_t i = 0; i < shape.corners.size(); ++i) {
    const Vec3 to = end.to_world(shape.corners[i]);
    const Vec3 from = start.to_world(shape.corners[i]) + drift;
    if (body_bounds_.misses(from, to, reach)) {
      continue;
    }
    SkinPoint skin;
    const bool far_moved = (to - from).squaredNorm() > kTrustedDepth * kTrustedDepth;
    if (!(far_moved && crossed_face(body, from, to, skin))) {
      skin = {};
      if (!nearest_face(body, to, reach, skin)) {
        continue;
      }
    }
    const double gap = skin.distance - radius - margin;
    if (gap > kSlackMargins * margin) {
      continue;
    }
    identity.rigid_feature = static_cast<int>(i);
    Contact& contact = contacts.find_or_add(identity);
    contact.rigid = instance.rigid;
    contact.count = 3;
    Vec3 at_start = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      contact.points[k] = body.triangles_[static_cast<std::size_t>(skin.face)][k];
      contact.weights[k] = skin.weights[static_cast<Eigen::Index>(k)];
      at_start += contact.weights[k] * body.positions_[static_cast<std::size_t>(contact.points[k])];
    }
    contact.normal = -skin.outward;
    contact.gap = gap;
    contact.arm = at_start - rigid.start.origin;
    contact.seen = true;
  }
}

void ContactFinder::find_edges(int body_index, const Deformable& body, const ShapeInstance& instance,
                               const RigidState& rigid, double margin, ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose end = rigid.end * instance.local;
  const double radius = shape.feature_radius;
  const double reach = radius + (1.0 + kSlackMargins) * margin;
  const double deepest = std::min(0.05, 0.25 * shape.thinnest);
  Contact identity;
  identity.body = body_index;
  identity.object = rigid.object;
  identity.shape = instance.shape;
  identity.kind = ContactKind::edge;
  for (std::size_t i = 0; i < shape.edges.size(); ++i) {
    const ShapeEdge& edge = shape.edges[i];
    const Vec3 a = end.to_world(edge.a), b = end.to_world(edge.b);
    if (body_bounds_.misses(a, b, reach)) {
      continue;
    }
    const Vec3 into_first = end.rotation * edge.into_first, into_second = end.rotation * edge.into_second;
    const bool has_faces = edge.into_first != Vec3::Zero();
    const Vec3 low = a.cwiseMin(b).array() - (reach + deepest);
    const Vec3 high = a.cwiseMax(b).array() + (reach + deepest);
    for (std::size_t e = 0; e < body.edges_.size(); ++e) {
      const Vec3& p = body.end_positions_[static_cast<std::size_t>(body.edges_[e][0])];
      const Vec3& q = body.end_positions_[static_cast<std::size_t>(body.edges_[e][1])];
      if ((p.cwiseMin(q) - high).maxCoeff() > 0.0 || (low - p.cwiseMax(q)).maxCoeff() > 0.0) {
        continue;
      }
      double s = 0, t = 0;
      const Vec3 u = b - a, v = q - p;
      constexpr double kEnd = 1e-6;  // ends belong to corners and vertices
      if (!nearest_on_lines(a, u, p, v, s, t) || s < kEnd || s > 1 - kEnd || t < kEnd || t > 1 - kEnd) {
        continue;
      }
      const Vec3 m1 = face_normal(body, body.edge_faces_[e][0]);
      const Vec3 m2 = body.edge_faces_[e][1] >= 0 ? face_normal(body, body.edge_faces_[e][1]) : m1;
      // Directions from the skin's edge into its two faces; edges_ run along the first face.
      const Vec3 along = v.normalized();
      const Vec3 skin_first = m1.cross(along), skin_second = along.cross(m2);
      Vec3 normal = u.cross(v).normalized();
      if (normal.dot(m1 + m2) > 0.0) {
        normal = -normal;  // from the collider into the skin
      }
      if (-normal.dot(skin_first) > kWedgeSlack || -normal.dot(skin_second) > kWedgeSlack) {
        continue;  // a face or a hollow edge of the skin is nearer
      }
      if (has_faces && (normal.dot(into_first) > kWedgeSlack || normal.dot(into_second) > kWedgeSlack)) {
        continue;  // a face of the collider is nearer
      }
      const double gap = normal.dot((p + t * v) - (a + s * u)) - radius - margin;
      if (gap > kSlackMargins * margin || gap < -deepest - radius) {
        continue;
      }
      identity.rigid_feature = static_cast<int>(i);
      identity.skin_feature = static_cast<int>(e);
      Contact& contact = contacts.find_or_add(identity);
      contact.rigid = instance.rigid;
      contact.count = 2;
      contact.points = {body.edges_[e][0], body.edges_[e][1], 0};
      contact.weights = {1.0 - t, t, 0.0};
      contact.normal = normal;
      contact.gap = gap;
      contact.arm = (1.0 - t) * body.positions_[static_cast<std::size_t>(body.edges_[e][0])] +
                    t * body.positions_[static_cast<std::size_t>(body.edges_[e][1])] - rigid.start.origin;
      contact.seen = true;
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
