#include "skin.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

#include "nearest_points.h"

namespace softpoint::inline SOFTPOINT_ABI {

void Skin::update(const Deformable& body) {
  if (current_ && body_ == &body) {
    return;
  }
  const bool known = body_ == &body && face_boxes_.size() == body.triangles_.size() &&
                     edge_boxes_.size() == body.edges_.size();
  body_ = &body;
  current_ = true;
  const auto at = [&](int v) -> const Vec3& { return body.end_positions_[static_cast<std::size_t>(v)]; };
  face_boxes_.resize(body.triangles_.size());
  for (std::size_t f = 0; f < body.triangles_.size(); ++f) {
    const Triangle& t = body.triangles_[f];
    face_boxes_[f] = Bounds::of(at(t[0]));
    face_boxes_[f].include(at(t[1]));
    face_boxes_[f].include(at(t[2]));
  }
  edge_boxes_.resize(body.edges_.size());
  for (std::size_t e = 0; e < body.edges_.size(); ++e) {
    edge_boxes_[e] = Bounds::of(at(body.edges_[e][0]));
    edge_boxes_[e].include(at(body.edges_[e][1]));
  }
  if (known) {
    faces_.refit(face_boxes_);
    edges_.refit(edge_boxes_);
  } else {
    faces_.build(face_boxes_);
    edges_.build(edge_boxes_);
  }
  body.skin_normals(normals_);
  travel_ = 0.0;
  drift_.setZero();
  for (std::size_t v = 0; v < body.positions_.size(); ++v) {
    const Vec3 motion = body.end_positions_[v] - body.positions_[v];
    travel_ = std::max(travel_, motion.squaredNorm());
    drift_ += motion;
  }
  travel_ = std::sqrt(travel_);
  drift_ /= static_cast<double>(body.positions_.size());
}

Vec3 Skin::face_normal(int face, bool at_start) const {
  const Triangle& t = triangle(face);
  const std::vector<Vec3>& points = at_start ? start() : end();
  const auto at = [&](std::size_t k) -> const Vec3& { return points[static_cast<std::size_t>(t[k])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
}

Vec3 Skin::smooth_normal(int face, const Vec3& weights) const {
  const Triangle& t = triangle(face);
  return weights[0] * vertex_normal(t[0]) + weights[1] * vertex_normal(t[1]) +
         weights[2] * vertex_normal(t[2]);
}

// Where the segment from, from + d enters a face from outside (Moller-Trumbore): time 0 to 1 and weights.
bool Skin::segment_meets_front(int face, const Vec3& from, const Vec3& d, double& time, Vec3& weights) const {
  const Triangle& t = triangle(face);
  const auto at = [&](std::size_t k) -> const Vec3& { return end()[static_cast<std::size_t>(t[k])]; };
  const Vec3& a = at(0);
  const Vec3 e1 = at(1) - a, e2 = at(2) - a;
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

bool Skin::crossed_face(const Vec3& from, const Vec3& to, SkinPoint& hit) const {
  const Vec3 d = to - from;
  double first = 2.0;
  Bounds path = Bounds::of(from);
  path.include(to);
  faces_.in_region(path, [&](int f) {
    double time = 0;
    Vec3 weights;
    if (segment_meets_front(f, from, d, time, weights) && time < first) {
      first = time;
      hit.face = f;
      hit.weights = weights;
    }
  });
  if (hit.face < 0) {
    return false;
  }
  hit.outward = face_normal(hit.face, false);
  hit.distance = hit.outward.dot(to - (from + first * d));
  return true;
}

// Parity of the faces above p.
bool Skin::inside(const Vec3& p) const {
  bool odd = false;
  Bounds ray = Bounds::of(p);
  ray.high.z() = std::max(ray.high.z(), bounds().high.z());
  faces_.in_region(ray, [&](int f) {
    const Triangle& t = triangle(f);
    const Vec3 a = end()[static_cast<std::size_t>(t[0])] - p;
    const Vec3 b = end()[static_cast<std::size_t>(t[1])] - p;
    const Vec3 c = end()[static_cast<std::size_t>(t[2])] - p;
    const double wa = b.x() * c.y() - b.y() * c.x(), wb = c.x() * a.y() - c.y() * a.x(),
                 wc = a.x() * b.y() - a.y() * b.x();
    if ((wa > 0) == (wb > 0) && (wb > 0) == (wc > 0)) {
      odd ^= (wa * a.z() + wb * b.z() + wc * c.z()) / (wa + wb + wc) > 0.0;
    }
  });
  return odd;
}

bool Skin::nearest_face(const Vec3& p, double reach, SkinPoint& nearest) const {
  double best = reach * reach;
  Vec3 at = Vec3::Zero(), side = Vec3::Zero();
  faces_.near_point(p, best, [&](int f) {
    const Triangle& t = triangle(f);
    const auto corner = [&](std::size_t k) -> const Vec3& { return end()[static_cast<std::size_t>(t[k])]; };
    const Vec3 w = nearest_weights(p, corner(0), corner(1), corner(2));
    const Vec3 q = w[0] * corner(0) + w[1] * corner(1) + w[2] * corner(2);
    const double squared = (p - q).squaredNorm();
    constexpr double kSame = 1e-18;  // m^2: the same edge seen from its other face
    if (squared > best + kSame) {
      return;
    }
    const Vec3 normal = face_normal(f, false);
    if (nearest.face >= 0 && squared > best - kSame) {
      side += normal;
      return;
    }
    best = squared;
    nearest.face = f;
    nearest.weights = w;
    at = q;
    side = normal;
  });
  if (nearest.face < 0) {
    return false;
  }
  side.normalize();
  const double length = std::sqrt(best);
  const double sign = (p - at).dot(side) < 0.0 ? -1.0 : 1.0;
  nearest.distance = sign * length;
  nearest.outward = length > 1e-9 ? Vec3(sign * (p - at) / length) : side;
  return true;
}

bool Skin::along(const Vec3& p, const Vec3& direction, double reach, SkinPoint& hit) const {
  const Vec3 from = p - reach * direction;
  const Vec3 d = 2.0 * reach * direction;
  Bounds path = Bounds::of(from);
  path.include(from + d);
  double best = 1.0;  // |time - 1/2|
  faces_.in_region(path, [&](int f) {
    double time = 0;
    Vec3 weights;
    if (segment_meets_front(f, from, d, time, weights) && std::abs(time - 0.5) < best) {
      best = std::abs(time - 0.5);
      hit.face = f;
      hit.weights = weights;
      hit.distance = (time - 0.5) * 2.0 * reach;
    }
  });
  return hit.face >= 0;
}

}  // namespace softpoint::inline SOFTPOINT_ABI
