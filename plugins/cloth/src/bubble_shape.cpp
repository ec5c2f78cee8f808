// Volumes, rims and what closes a bubble.
#include <algorithm>
#include <cmath>

#include "bubble_finder.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// Volume between a triangle a, b, c and its shadow p, q, r, with bilinear sides: the integral of the mean
// distance against the area swept. Over a plane it is projected area times mean height, (3.10). Neighbours
// share their sides, so that the volumes of a bubble's faces add up to its own.
double prism(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& q, const Vec3& r) {
  const Vec3 c1 = b - a, c2 = c - a, f1 = q - p, f2 = r - p;
  const Vec3 distance = (a - p) + (b - q) + (c - r);
  return distance.dot(2 * (f1.cross(f2) + c1.cross(c2)) + f1.cross(c2) + c1.cross(f2)) / 36;
}

}  // namespace

void BubbleFinder::measure_faces(const AirFrame& frame) {
  for (std::size_t f = 0; f < face_volume_.size(); ++f) {
    if (bubble_of(static_cast<int>(f)) < 0) {
      face_volume_[f] = 0;
      continue;
    }
    const auto [a, b, c] = topology_.faces[f];
    const auto& x = frame.positions;
    face_volume_[f] = topology_.closed[f]
                          ? cone(x[a], x[b], x[c])
                          : prism(x[a], x[b], x[c], frame.feet[a], frame.feet[b], frame.feet[c]);
  }
}

void BubbleFinder::measure_pockets(const AirFrame& frame) {
  for (std::size_t i = 0; i < pockets_.size(); ++i) {
    Bubble& bubble = bubbles_[i];
    const Bubble last = bubble;
    bubble = Bubble{};
    bubble.closed = last.closed;
    bubble.thin = last.thin;
    bubble.patch = last.patch;
    bubble.touched = last.touched;
    bubble.unsealed = last.unsealed;
    pockets_[i].closure = 0;
  }
  const auto& x = frame.positions;
  const auto& p = frame.feet;
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    const int pocket = face_pocket_[f];
    if (pocket < 0) continue;
    const auto [a, b, c] = topology_.faces[f];
    Bubble& bubble = bubbles_[pocket];
    const double area = topology_.face_areas[f];
    ++bubble.faces;
    bubble.area += area;
    bubble.volume += face_volume_[f];
    bubble.open_weave += area * dry_pores_[f];
    if (bubble.closed) continue;
    if (!bubble.patch) pockets_[pocket].closure -= cone(p[a], p[b], p[c]);
    bubble.facing +=
        (x[b] - x[a]).cross(x[c] - x[a]).dot(frame.normals[a] + frame.normals[b] + frame.normals[c]) / 6;
  }
  for (std::size_t i = 0; i < pockets_.size(); ++i) {
    Bubble& bubble = bubbles_[i];
    AirPocket& pocket = pockets_[i];
    bubble.wet_weave = settings_.permeability * (bubble.area - bubble.open_weave);
    bubble.open_weave *= settings_.permeability;
    // Cloth that stands on edge keeps the side it had.
    const double facing = bubble.closed ? bubble.volume : bubble.facing;
    if (std::abs(facing) > (bubble.closed ? 0.0 : 0.05 * bubble.area)) pocket.side = facing < 0 ? -1 : 1;
    bubble.volume *= pocket.side;
    bubble.folded = bubble.volume < 0;
    counts_.folded += bubble.folded;
    const double thickness = bubble.volume / bubble.area;
    const double least = settings_.min_thickness * (bubble.thin ? 2 : 1);
    bubble.thin = settings_.bubbles == Bubbles::kFound && !bubble.closed && !bubble.patch && thickness >= 0 &&
                  thickness < least;
  }
}

// Sides of edges where a bubble ends: the border of the cloth, of the contact patch, of another bubble, of
// what is within reach of a collider.
void BubbleFinder::collect_rims() {
  rim_unsorted_.clear();
  rim_cursor_.assign(pockets_.size() + 1, 0);
  const auto add = [&](int e, int face, int beyond, bool reversed) {
    const int pocket = face < 0 ? -1 : face_pocket_[face];
    if (pocket < 0 || topology_.closed[face]) return;
    if (beyond >= 0 && face_pocket_[beyond] == pocket) return;
    const AirTopology::Edge& edge = topology_.edges[e];
    const bool free = beyond < 0 || (face_pocket_[beyond] < 0 && !wholly_touching(edge));
    rim_unsorted_.push_back({e, face, reversed, free, 0});
    ++rim_cursor_[pocket + 1];
  };
  for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
    const AirTopology::Edge& edge = topology_.edges[e];
    add(static_cast<int>(e), edge.face, edge.other, false);
    add(static_cast<int>(e), edge.other, edge.face, true);
  }
  for (std::size_t i = 1; i < rim_cursor_.size(); ++i) rim_cursor_[i] += rim_cursor_[i - 1];
  rim_list_.assign(rim_unsorted_.size(), Rim{});
  for (const Rim& rim : rim_unsorted_) rim_list_[rim_cursor_[face_pocket_[rim.face]]++] = rim;
}

void BubbleFinder::measure_rims(std::span<const double> gaps) {
  rims_.clear();
  std::size_t r = 0;
  for (std::size_t i = 0; i < pockets_.size(); ++i) {
    bubbles_[i].rim_begin = static_cast<int>(r);
    while (r < rim_list_.size() && face_pocket_[rim_list_[r].face] == static_cast<int>(i)) ++r;
  }
  for (Rim& rim : rim_list_) {
    const AirTopology::Edge& edge = topology_.edges[rim.edge];
    rim.gap = (std::max(gaps[edge.a], 0.0) + std::max(gaps[edge.b], 0.0)) / 2;
  }
}

// Of the ambient pressure: what no rim holds, however wet, for longer than some milliseconds. A tenth of an
// atmosphere is a ton a square metre.
constexpr double kBurst = 0.1;

// What has touched and does no longer anywhere has come off: nothing seals it but a rim that is near all
// round.
void BubbleFinder::find_loose() {
  if (settings_.vent || settings_.bubbles != Bubbles::kFound) return;
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    const int i = bubble_of(static_cast<int>(f));
    if (i < 0) continue;
    const auto [a, b, c] = topology_.faces[f];
    bubbles_[i].touches = bubbles_[i].touches || touching_[a] || touching_[b] || touching_[c];
  }
  for (int i = 0; i < bubble_count_; ++i) {
    Bubble& bubble = bubbles_[i];
    bubble.unsealed = bubble.unsealed || (bubble.touched && !bubble.touches && !bubble.closed);
    bubble.touched = bubble.touched || bubble.touches;
    bubble.touches = false;
  }
}

void BubbleFinder::close_pockets() {
  for (std::size_t i = 0; i < pockets_.size(); ++i) {
    AirPocket& pocket = pockets_[i];
    Bubble& bubble = bubbles_[i];
    pocket.closure = bubble.closed ? 0.0 : pocket.closure;
    pocket.ambient = settings_.ambient;
    pocket.max_suction =
        settings_.limit_suction && !bubble.closed ? bubble_point(settings_) : AirPocket{}.max_suction;
    pocket.min_pressure =
        settings_.limit_suction ? std::min(settings_.vapour_pressure, settings_.ambient) : 0.0;
    pocket.open = bubble.thin;
    pocket.max_gauge = settings_.vent && !bubble.closed && settings_.bubbles == Bubbles::kFound
                           ? kBurst * settings_.ambient
                           : AirPocket{}.max_gauge;
    if (bubble.patch) continue;
    const int end = rim_end(static_cast<int>(i));
    bool wide = false;
    for (int r = bubble.rim_begin; !wide && r < end; ++r) {
      wide = rim_list_[r].free && rim_list_[r].gap > settings_.bridge_gap;
    }
    // Without `vent` a rim that was sealed stays so whatever its gap; but a corner alone seals none.
    bubble.unsealed = bubble.unsealed && wide;
    pocket.open = pocket.open || (wide && (settings_.vent || bubble.unsealed));
    // A gap no film spans lets its air through at once.
    if (pocket.open && !bubble.thin && bubble.volume > 0) {
      vent(static_cast<int>(i), pocket.air - settings_.ambient * bubble.volume);
    }
    counts_.open += pocket.open;
  }
}

// m; a patch at rest is closed by that much, or rounding would decide between no suction and all of it.
constexpr double kPatchSlack = 1e-9;

// A patch counts its volume from where it is now: suction lets none of it open, and pushes nothing.
void BubbleFinder::close_patches(std::span<const Vec3> positions) {
  if (bubble_count_ == static_cast<int>(pockets_.size())) return;
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    const int pocket = face_pocket_[f];
    if (pocket < bubble_count_) continue;
    const auto [a, b, c] = topology_.faces[f];
    pockets_[pocket].closure -= cone(positions[a], positions[b], positions[c]);
  }
  for (const RimQuad& rim : rims_) {
    if (rim.pocket < bubble_count_) continue;
    pockets_[rim.pocket].closure -= cone(positions[rim.b], positions[rim.a], rim.foot_a, rim.foot_b);
  }
  for (std::size_t i = bubble_count_; i < pockets_.size(); ++i) {
    pockets_[i].max_gauge = 0;
    pockets_[i].closure -= pockets_[i].side * kPatchSlack * bubbles_[i].area;
  }
}

void BubbleFinder::adhere(std::span<const double> gaps) {
  if (!settings_.adhesion) return;
  std::fill(adhesion_.begin(), adhesion_.end(), 0.0);
  const auto hold = [&](int point) {
    if (!touching_[point] || saturation_[point] < settings_.wet || adhesion_[point] > 0) return;
    adhesion_[point] = film_adhesion(settings_, gaps[point]) * topology_.point_areas[point];
  };
  // The film ends, and its meniscus pulls, where the patch does.
  for (int i = 0; i < topology_.points; ++i) {
    if (border_point_[i]) hold(i);
  }
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (!airy_[f] || topology_.closed[f]) continue;
    for (const int point : topology_.faces[f]) hold(point);
  }
}

void BubbleFinder::add_foot_forces(const AirFrame& frame, std::span<const double> gauges,
                                   std::span<Vec3> forces) const {
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    const int pocket = face_pocket_[f];
    if (pocket < 0 || topology_.closed[f] || gauges[pocket] == 0) continue;
    const auto [a, b, c] = topology_.faces[f];
    const Vec3 &p = frame.feet[a], &q = frame.feet[b], &r = frame.feet[c];
    const double scale = -gauges[pocket] * pockets_[pocket].side / 6;
    forces[a] += scale * q.cross(r);
    forces[b] += scale * r.cross(p);
    forces[c] += scale * p.cross(q);
  }
  for (const RimQuad& rim : rims_) {
    const double scale = gauges[rim.pocket] * pockets_[rim.pocket].side;
    if (scale == 0) continue;
    const Vec3 &a = frame.positions[rim.a], &b = frame.positions[rim.b];
    forces[rim.a] += scale * cone_gradient(rim.foot_b, b, a);
    forces[rim.b] += scale * cone_gradient(b, a, rim.foot_a);
  }
}

double BubbleFinder::volume(int pocket, std::span<const Vec3> positions) const {
  double sum = pockets_[pocket].closure;
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (face_pocket_[f] != pocket) continue;
    const auto [a, b, c] = topology_.faces[f];
    sum += cone(positions[a], positions[b], positions[c]);
  }
  for (int r = bubbles_[pocket].rim_begin; r < rim_end(pocket); ++r) {
    const RimQuad& rim = rims_[r];
    sum += cone(positions[rim.b], positions[rim.a], rim.foot_a, rim.foot_b);
  }
  return sum * pockets_[pocket].side;
}

int BubbleFinder::rim_end(int pocket) const {
  return pocket + 1 < static_cast<int>(bubbles_.size()) ? bubbles_[pocket + 1].rim_begin
                                                        : static_cast<int>(rim_list_.size());
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
