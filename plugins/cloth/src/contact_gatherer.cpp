#include "contact_gatherer.h"

#include <algorithm>
#include <limits>

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Planes with a higher cosine count as one: the nearer of them holds.
constexpr double kSamePlane = 0.95;
// m; a surface is asked anew when its point has slid this far along it. On a curvature of 5 cm that is 1 um.
constexpr double kSlide = 3e-4;

}  // namespace

ContactGatherer::ContactGatherer(std::size_t points)
    : contacts_(points),
      slots_(points),
      plane_gaps_(points),
      feet_(points, Vec3::Zero()),
      normals_(points, Vec3::UnitZ()),
      gathered_at_(points, Vec3::Zero()),
      gaps_(points, kInfinity),
      friction_(points, 1.0),
      adhesion_(points, 0.0),
      colliders_(points, -1) {
  candidates_.reserve(points);
  moving_.reserve(points);
}

void ContactGatherer::gather(const NearColliders& near, const Points& points, const Reach& reach) {
  reach_ = reach;
  queries_ = 0;
  for (PointContacts& contacts : contacts_) {
    contacts.count = 0;
  }
  std::fill(gaps_.begin(), gaps_.end(), kInfinity);
  std::fill(colliders_.begin(), colliders_.end(), -1);
  std::copy(points.friction_factor.begin(), points.friction_factor.end(), friction_.begin());
  std::copy(points.positions.begin(), points.positions.end(), gathered_at_.begin());
  const double farthest = std::max(reach.air, reach.motion) + reach.half_thickness;
  for (int piece = 0; piece < near.pieces(); ++piece) {
    if (near.piece(piece).plane) {
      Vec3 normal;
      double offset = 0;
      near.plane(piece, normal, offset);
      for (std::size_t v = 0; v < points.positions.size(); ++v) {
        const double gap = normal.dot(points.positions[v]) - offset;
        if (gap <= farthest) {
          visit(near, piece, static_cast<int>(v), points.positions[v], gap, normal);
        }
      }
      continue;
    }
    near.candidates(piece, points.positions, farthest, candidates_);
    const std::span<signed char> sides = near.sides(piece);
    for (const int v : candidates_) {
      NearSurface surface;
      signed char front = 1;
      signed char& side = sides.empty() ? front : sides[static_cast<std::size_t>(v)];
      const Vec3& at = points.positions[static_cast<std::size_t>(v)];
      ++queries_;
      if (near.nearest(piece, at, farthest, side, surface)) {
        visit(near, piece, v, at, surface.gap, surface.normal);
      }
    }
  }
  planes_ = 0;
  moving_.clear();
  for (std::size_t v = 0; v < contacts_.size(); ++v) {
    bool moves = false;
    for (int k = 0; k < contacts_[v].count; ++k) {
      const NearColliders::Piece& piece = near.piece(slots_[v][static_cast<std::size_t>(k)].piece);
      moves |=
          !piece.plane || near.collider(piece.collider).movable || !contacts_[v].planes[k].velocity.isZero(0);
    }
    planes_ += contacts_[v].count;
    if (moves) {
      moving_.push_back(static_cast<int>(v));
    }
  }
}

// A surface near a point: it may be its foot, and one of its two planes.
void ContactGatherer::visit(const NearColliders& near, int piece, int point, const Vec3& at, double gap,
                            const Vec3& normal) {
  const auto v = static_cast<std::size_t>(point);
  const double clear = gap - reach_.half_thickness;
  if (reach_.air > 0.0 && clear < reach_.air && std::max(clear, 0.0) < gaps_[v]) {
    gaps_[v] = std::max(clear, 0.0);
    feet_[v] = at - clear * normal;
    normals_[v] = normal;
    colliders_[v] = near.piece(piece).collider;
  }
  if (clear > reach_.motion) {
    return;
  }
  PointContacts& contacts = contacts_[v];
  std::array<double, 2>& gaps = plane_gaps_[v];
  const auto put = [&](int k) {
    gaps[static_cast<std::size_t>(k)] = gap;
    slots_[v][static_cast<std::size_t>(k)] = {piece, near.to_local(near.piece(piece).collider, at)};
    set_plane(near, piece, point, at, gap, normal, contacts.planes[k]);
  };
  if (contacts.count == 0) {
    contacts.count = 1;
    put(0);
    return;
  }
  const auto same = [&](int k) { return contacts.planes[k].normal.dot(normal) > kSamePlane; };
  if (same(0)) {
    if (gap < gaps[0]) {
      put(0);
    }
    return;
  }
  if (gap < gaps[0]) {
    contacts.planes[1] = contacts.planes[0];
    slots_[v][1] = slots_[v][0];
    gaps[1] = gaps[0];
    put(0);
    contacts.count = 2;
  } else if (contacts.count == 1 || gap < gaps[1]) {
    contacts.count = 2;
    put(1);
  }
}

void ContactGatherer::set_plane(const NearColliders& near, int piece, int point, const Vec3& at, double gap,
                                const Vec3& normal, ContactPlane& plane) const {
  const int collider = near.piece(piece).collider;
  const Vec3 surface = at - gap * normal;
  plane.normal = normal;
  plane.foot = surface + reach_.half_thickness * normal;
  plane.velocity = near.velocity_at(collider, surface);
  plane.friction = near.collider(collider).friction * friction_[static_cast<std::size_t>(point)];
  plane.adhesion = adhesion_[static_cast<std::size_t>(point)];
  plane.collider = collider;
}

void ContactGatherer::set_adhesion(std::span<const double> adhesion) {
  for (std::size_t v = 0; v < contacts_.size(); ++v) {
    adhesion_[v] = adhesion.empty() ? 0.0 : adhesion[v];
    if (contacts_[v].count > 0) {
      contacts_[v].planes[0].adhesion = adhesion_[v];
    }
  }
}

bool ContactGatherer::follow(const NearColliders& near, const Points& points) {
  for (const int point : moving_) {
    const auto v = static_cast<std::size_t>(point);
    const Vec3& at = points.positions[v];
    for (int k = 0; k < contacts_[v].count; ++k) {
      ContactPlane& plane = contacts_[v].planes[k];
      Slot& slot = slots_[v][static_cast<std::size_t>(k)];
      const NearColliders::Piece& piece = near.piece(slot.piece);
      const double adhesion = plane.adhesion;
      if (piece.plane) {
        Vec3 normal;
        double offset = 0;
        near.plane(slot.piece, normal, offset);
        set_plane(near, slot.piece, point, at, normal.dot(at) - offset, normal, plane);
        plane.adhesion = adhesion;
        continue;
      }
      const bool still = plane.velocity.isZero(0) && !near.collider(piece.collider).movable;
      const Vec3 local = near.to_local(piece.collider, at);
      if (still && (local - slot.asked_at).squaredNorm() < kSlide * kSlide) {
        continue;
      }
      const std::span<signed char> sides = near.sides(slot.piece);
      signed char front = 1;
      NearSurface surface;
      ++queries_;
      if (near.nearest(slot.piece, at, kInfinity, sides.empty() ? front : sides[v], surface)) {
        slot.asked_at = local;
        set_plane(near, slot.piece, point, at, surface.gap, surface.normal, plane);
        plane.adhesion = adhesion;
      }
    }
  }
  return !moving_.empty();
}

bool ContactGatherer::outrun(std::span<const Vec3> positions) const {
  const double limit = reach_.motion * reach_.motion;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if ((positions[v] - gathered_at_[v]).squaredNorm() > limit) {
      return true;
    }
  }
  return false;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
