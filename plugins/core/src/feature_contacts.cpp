// Corners of boxes against the faces of a deformable. Edges: edge_contacts.cpp.
#include <algorithm>
#include <cmath>

#include "contact_finder.h"
#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {
Vec3 ContactFinder::face_normal(const Deformable& body, const std::vector<Vec3>& points, int face) const {
  const Triangle& t = body.triangles_[static_cast<std::size_t>(face)];
  const auto at = [&](int i) -> const Vec3& { return points[static_cast<std::size_t>(i)]; };
  return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).normalized();
}

void ContactFinder::begin_pass(const Deformable& body) {
  face_bounds_.resize(body.triangles_.size());
  body_bounds_.low = body_bounds_.high = body.end_positions_.front();
  for (const Vec3& p : body.end_positions_) {
    body_bounds_.low = body_bounds_.low.cwiseMin(p);
    body_bounds_.high = body_bounds_.high.cwiseMax(p);
  }
  body.skin_normals(normals_);
  step_travel_ = 0.0;
  for (std::size_t v = 0; v < body.positions_.size(); ++v) {
    step_travel_ = std::max(step_travel_, (body.end_positions_[v] - body.positions_[v]).squaredNorm());
  }
  step_travel_ = std::sqrt(step_travel_);
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    const Triangle& t = body.triangles_[f];
    const auto at = [&](int k) -> const Vec3& {
      return body.end_positions_[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
    };
    face_bounds_[f] = {at(0).cwiseMin(at(1)).cwiseMin(at(2)), at(0).cwiseMax(at(1)).cwiseMax(at(2))};
  }
}

// Where the segment from, from + d enters a face from outside (Moller-Trumbore): time 0 to 1 and weights.
bool ContactFinder::segment_meets_front(const Deformable& body, int face, const Vec3& from, const Vec3& d,
                                        double& time, Vec3& weights) {
  const Triangle& t = body.triangles_[static_cast<std::size_t>(face)];
  const Vec3& a = body.end_positions_[static_cast<std::size_t>(t[0])];
  const Vec3 e1 = body.end_positions_[static_cast<std::size_t>(t[1])] - a;
  const Vec3 e2 = body.end_positions_[static_cast<std::size_t>(t[2])] - a;
  const Vec3 q = d.cross(e2);
  const double determinant = e1.dot(q);
  if (determinant <= 0.0) {
    return false;
  }
  const Vec3 s = from - a;
  const double u = s.dot(q) / determinant;
  const Vec3 r = s.cross(e1);
  const double v = d.dot(r) / determinant;
  time = e2.dot(r) / determinant;
  weights = {1.0 - u - v, u, v};
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && time >= 0.0 && time <= 1.0;
}

// First face that the segment enters from outside.
bool ContactFinder::crossed_face(const Deformable& body, const Vec3& from, const Vec3& to,
                                 SkinPoint& hit) const {
  const Vec3 d = to - from;
  double first = 2.0;
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    double time = 0;
    Vec3 weights;
    if (face_bounds_[f].misses(from, to, 0.0) ||
        !segment_meets_front(body, static_cast<int>(f), from, d, time, weights) || time >= first) {
      continue;
    }
    first = time;
    hit.face = static_cast<int>(f);
    hit.weights = weights;
  }
  if (hit.face < 0) {
    return false;
  }
  hit.outward = face_normal(body, body.end_positions_, hit.face);
  hit.distance = hit.outward.dot(to - (from + first * d));
  return true;
}

// Whether p lies inside the closed skin: parity of the faces above it.
bool ContactFinder::inside(const Deformable& body, const Vec3& p) const {
  bool odd = false;
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    const Bounds& bounds = face_bounds_[f];
    if (p.x() < bounds.low.x() || p.x() > bounds.high.x() || p.y() < bounds.low.y() ||
        p.y() > bounds.high.y() || p.z() > bounds.high.z()) {
      continue;
    }
    const Triangle& t = body.triangles_[f];
    const Vec3 a = body.end_positions_[static_cast<std::size_t>(t[0])] - p;
    const Vec3 b = body.end_positions_[static_cast<std::size_t>(t[1])] - p;
    const Vec3 c = body.end_positions_[static_cast<std::size_t>(t[2])] - p;
    const double wa = b.x() * c.y() - b.y() * c.x(), wb = c.x() * a.y() - c.y() * a.x(),
                 wc = a.x() * b.y() - a.y() * b.x();
    if ((wa > 0) == (wb > 0) && (wb > 0) == (wc > 0)) {
      odd ^= (wa * a.z() + wb * b.z() + wc * c.z()) / (wa + wb + wc) > 0.0;
    }
  }
  return odd;
}

// Nearest point of the skin with its signed distance; false beyond `reach`, or outside where a vertex is
// nearest (vertices make contacts of their own).
bool ContactFinder::nearest_face(const Deformable& body, const Vec3& p, double reach,
                                 SkinPoint& nearest) const {
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
    const Vec3 normal = face_normal(body, body.end_positions_, static_cast<int>(f));
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
  if (nearest.face < 0) {
    return false;
  }
  side.normalize();
  const double length = std::sqrt(best);
  const double sign = (p - at).dot(side) < 0.0 ? -1.0 : 1.0;
  if (sign > 0.0 && nearest.weights.maxCoeff() > 1.0 - 1e-9) {
    return false;
  }
  nearest.distance = sign * length;
  nearest.outward = length > 1e-9 ? Vec3(sign * (p - at) / length) : side;
  return true;
}

// The direction in which a corner presses at a point of the skin: against the smooth normal there, but within
// the cone of directions in which the corner is the foremost point of its shape.
Vec3 ContactFinder::press_direction(const Deformable& body, const SkinPoint& skin, const ColliderShape& shape,
                                    std::size_t corner, const Pose& pose) const {
  const Triangle& t = body.triangles_[static_cast<std::size_t>(skin.face)];
  Vec3 direction = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    direction -= skin.weights[static_cast<Eigen::Index>(k)] * normals_[static_cast<std::size_t>(t[k])];
  }
  direction = pose.rotation.transpose() * direction;
  for (int round = 0; round < 3; ++round) {
    for (const Vec3& edge : shape.corner_edges[corner]) {
      direction -= std::max(direction.dot(edge), 0.0) * edge;
    }
  }
  const double length = direction.norm();
  return length > 1e-6 ? Vec3(pose.rotation * direction / length) : Vec3(-skin.outward);
}

// Where the line through a corner along `direction` meets the skin from outside, nearest to the corner; the
// distance is negative when the corner has passed it.
bool ContactFinder::skin_along(const Deformable& body, const Vec3& corner, const Vec3& direction,
                               double reach, SkinPoint& hit) const {
  const Vec3 from = corner - reach * direction;
  const Vec3 d = 2.0 * reach * direction;
  double best = 1.0;  // |time - 1/2|
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    if (face_bounds_[f].misses(from, from + d, 0.0)) {
      continue;
    }
    double time = 0;
    Vec3 weights;
    if (!segment_meets_front(body, static_cast<int>(f), from, d, time, weights) ||
        std::abs(time - 0.5) >= best) {
      continue;
    }
    best = std::abs(time - 0.5);
    hit.face = static_cast<int>(f);
    hit.weights = weights;
    hit.distance = (time - 0.5) * 2.0 * reach;
  }
  return hit.face >= 0;
}

void ContactFinder::find_corners(int body_index, const Deformable& body, const ShapeInstance& instance,
                                 const RigidState& rigid, double margin, ContactTable& contacts) {
  const ColliderShape& shape = *instance.collider;
  const Pose start = rigid.start * instance.local;
  const Pose end = rigid.end * instance.local;
  const Vec3 size = body_bounds_.high - body_bounds_.low;
  const double reach = std::max(0.02, 0.1 * size.maxCoeff());
  // Motion of the body as a whole, so that the path of a corner is seen from the body.
  Vec3 drift = Vec3::Zero();
  for (std::size_t v = 0; v < body.positions_.size(); ++v) {
    drift += body.end_positions_[v] - body.positions_[v];
  }
  drift /= static_cast<double>(body.positions_.size());

  Contact identity;
  identity.body = body_index;
  identity.object = rigid.object;
  identity.child = instance.child;
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
        skin = {};
        if (body_bounds_.misses(to, to, 0.0) || !inside(body, to) ||
            !nearest_face(body, to, size.norm(), skin)) {
          continue;
        }
      }
    }
    if (skin.distance - margin > kSlackMargins * margin) {
      continue;
    }
    identity.rigid_feature = static_cast<int>(i);
    Contact& contact = contacts.find_or_add(identity);
    if (contact.met) {
      continue;  // refresh() follows it in the direction in which it began to press
    }
    contact.normal = press_direction(body, skin, shape, i, end);
    SkinPoint along;
    const double look = 2.0 * std::abs(skin.distance) + 0.25 * size.norm();
    if (skin_along(body, to, contact.normal, look, along)) {
      skin = along;
    }
    contact.rigid = instance.rigid;
    contact.shape_index = instance.index;
    contact.gap = skin.distance - margin;
    contact.rigid_point = rigid.end.to_local(to);
    place_on_face(body, skin.face, skin.weights, rigid, contact);
    contact.seen = contact.met = true;
  }
}

void ContactFinder::place_on_face(const Deformable& body, int face, const Vec3& weights,
                                  const RigidState& rigid, Contact& contact) {
  contact.count = 3;
  Vec3 at_start = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    contact.points[k] = body.triangles_[static_cast<std::size_t>(face)][k];
    contact.weights[k] = weights[static_cast<Eigen::Index>(k)];
    at_start += contact.weights[k] * body.impulse_points_[static_cast<std::size_t>(contact.points[k])];
  }
  contact.arm = at_start - rigid.start.origin;
}

bool ContactFinder::refresh(const Deformable& body, const ShapeInstance& instance, const RigidState& rigid,
                            double margin, Contact& contact) const {
  const Pose end = rigid.end * instance.local;
  const ColliderShape& shape = *instance.collider;
  const auto skin_point = [&] {
    Vec3 sum = Vec3::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(contact.count); ++k) {
      sum += contact.weights[k] * body.end_positions_[static_cast<std::size_t>(contact.points[k])];
    }
    return sum;
  };
  if (contact.kind == ContactKind::face) {
    follow_face(body, instance, rigid, margin, contact);
    return true;
  }
  if (contact.kind == ContactKind::corner) {
    const Vec3 corner = end.to_world(shape.corners[static_cast<std::size_t>(contact.rigid_feature)]);
    const Vec3 size = body_bounds_.high - body_bounds_.low;
    SkinPoint along;
    if (!skin_along(body, corner, contact.normal, 0.5 * size.norm(), along)) {
      return false;
    }
    contact.gap = along.distance - margin;
    place_on_face(body, along.face, along.weights, rigid, contact);
    return true;
  }
  // On the plane it had: through a point of the collider, with a fixed normal.
  contact.gap = contact.normal.dot(skin_point() - rigid.end.to_world(contact.rigid_point)) - margin;
  return true;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
