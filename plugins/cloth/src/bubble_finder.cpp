#include "bubble_finder.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "disjoint_sets.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

BubbleFinder::BubbleFinder(AirTopology topology, const AirSettings& settings)
    : topology_(std::move(topology)), settings_(settings) {
  check(settings);
  const std::size_t points = topology_.points, faces = topology_.faces.size(), edges = topology_.edges.size();
  has_closed_ = std::find(topology_.closed.begin(), topology_.closed.end(), 1) != topology_.closed.end();
  saturation_.assign(points, 0.0);
  dry_pores_.assign(faces, 1.0);
  touching_.assign(points, 0);
  touch_frames_.assign(points, 0);
  airy_.assign(faces, 0);
  reachable_.assign(faces, 0);
  point_pocket_.assign(points, kNone);
  point_face_.assign(points, kNone);
  face_pocket_.assign(faces, -1);
  old_face_pocket_.assign(faces, -1);
  parents_.assign(faces, 0);
  face_volume_.assign(faces, 0.0);
  parked_.assign(faces, 0.0);
  // There are no more bubbles than faces, no more quads than sides of edges.
  pockets_.reserve(faces);
  old_pockets_.reserve(faces);
  bubbles_.reserve(faces + 1);
  old_weight_.reserve(faces);
  old_area_.reserve(faces);
  old_seals_.reserve(faces);
  old_children_.reserve(faces);
  seen_by_.reserve(faces);
  face_order_.assign(faces, 0);
  order_cursor_.reserve(faces + 1);
  rims_.reserve(2 * edges);
  rim_list_.reserve(2 * edges);
  rim_unsorted_.reserve(2 * edges);
  rim_cursor_.reserve(faces + 1);
  border_point_.assign(points, 0);
  adhesion_.assign(points, 0.0);
  openings_.reserve(2 * edges + 2);
  for (const AirTopology::Edge& edge : topology_.edges) {
    if (edge.other < 0) border_point_[edge.a] = border_point_[edge.b] = 1;
  }
}

void BubbleFinder::set_settings(const AirSettings& settings) {
  check(settings);
  if (settings.bubbles != settings_.bubbles) drop_all();
  settings_ = settings;
  repaint_ = true;
  find_wet();
}

void BubbleFinder::find_wet() {
  wet_ = std::any_of(saturation_.begin(), saturation_.end(),
                     [&](double value) { return value > 0 && value >= settings_.wet; });
}

void BubbleFinder::set_saturation(std::span<const double> saturation) {
  if (static_cast<int>(saturation.size()) != topology_.points) {
    throw Error("saturation: " + std::to_string(saturation.size()) + " values; permitted: one a point, " +
                std::to_string(topology_.points));
  }
  for (const double value : saturation) check_range("saturation", value, 0, 1);
  repaint_ = repaint_ || !std::equal(saturation.begin(), saturation.end(), saturation_.begin());
  std::copy(saturation.begin(), saturation.end(), saturation_.begin());
  find_wet();
  for (std::size_t f = 0; f < dry_pores_.size(); ++f) {
    const Triangle& face = topology_.faces[f];
    const double dry = 1 - (saturation_[face[0]] + saturation_[face[1]] + saturation_[face[2]]) / 3;
    dry_pores_[f] = dry * dry * dry;
  }
}

bool BubbleFinder::find(const AirFrame& frame) {
  if (settings_.bubbles == Bubbles::kOff) {
    ++counts_.skipped_off;
    return false;
  }
  if (!wet_ && !has_closed_ && settings_.bubbles == Bubbles::kFound) {
    ++counts_.skipped_dry;
    drop_all();
    return false;
  }
  ++counts_.frames;
  const bool changed = update_touch(frame.gaps);
  if (changed) {
    group();
    number_pockets();
    if (settings_.bubbles == Bubbles::kFound && settings_.patch_suction) {
      add_ring();
      add_patches();
    }
  } else {
    ++counts_.labels_kept;
  }
  measure_faces(frame);
  if (changed) {
    move_air();
    collect_rims();
  }
  measure_pockets(frame);
  if (fresh_) first_air();
  fresh_ = false;
  take_parked();
  measure_rims(frame.gaps);
  for (const Rim& rim : rim_list_) {
    const AirTopology::Edge& edge = topology_.edges[rim.edge];
    const int a = rim.reversed ? edge.b : edge.a, b = rim.reversed ? edge.a : edge.b;
    rims_.push_back({face_pocket_[rim.face], a, b, frame.feet[a], frame.feet[b]});
  }
  find_loose();
  close_pockets();
  close_patches(frame.positions);
  adhere(frame.gaps);
  return std::any_of(pockets_.begin(), pockets_.end(), [](const AirPocket& pocket) { return !pocket.open; });
}

// Hysteresis in space, and a touch counts only once it has lasted: so a point that rattles between the two
// gaps, or in and out of them, parts nothing. A release counts at once, or a fast lift would be late.
bool BubbleFinder::update_touch(std::span<const double> gaps) {
  bool changed = fresh_ || repaint_;
  repaint_ = false;
  const double touch = settings_.touch_gap, release = settings_.release_gap;
  for (int i = 0; i < topology_.points; ++i) {
    const bool near = gaps[i] <= touch;
    bool now = touching_[i] != 0;
    if (now) {
      now = gaps[i] <= release;
    } else {
      touch_frames_[i] = near ? touch_frames_[i] + 1 : 0;
      now = near && (fresh_ || touch_frames_[i] >= settings_.lifetime);
    }
    if (now != (touching_[i] != 0)) {
      touching_[i] = now;
      touch_frames_[i] = 0;
      changed = true;
    }
  }
  // Coming into reach of a collider, or leaving it, moves faces in and out of bubbles too.
  for (std::size_t f = 0; f < topology_.faces.size(); ++f) {
    const Triangle& face = topology_.faces[f];
    const bool reach =
        std::isfinite(gaps[face[0]]) && std::isfinite(gaps[face[1]]) && std::isfinite(gaps[face[2]]);
    const bool touches = touching_[face[0]] && touching_[face[1]] && touching_[face[2]];
    const char airy = topology_.closed[f] ? 1 : reach && (settings_.bubbles == Bubbles::kOne || !touches);
    if (airy != airy_[f] || char(reach) != reachable_[f]) {
      airy_[f] = airy;
      reachable_[f] = reach;
      changed = true;
    }
  }
  return changed;
}

// Faces with air under them that have a point in common. A line of contact without a face of its own is no
// seal; and points that two pockets share would feel one of them late.
void BubbleFinder::group() {
  for (std::size_t f = 0; f < parents_.size(); ++f) parents_[f] = static_cast<int>(f);
  std::fill(point_face_.begin(), point_face_.end(), kNone);
  const DisjointSets sets(parents_);
  int first = kNone;  // pieces of an open cloth share the thesis' one bubble
  for (std::size_t f = 0; f < parents_.size(); ++f) {
    if (!airy_[f]) continue;
    const int face = static_cast<int>(f);
    join_by_points(face);
    if (settings_.bubbles != Bubbles::kOne || topology_.closed[f]) continue;
    if (first == kNone) first = face;
    sets.unite(first, face);
  }
}

void BubbleFinder::join_by_points(int face) {
  for (const int point : topology_.faces[face]) {
    int& known = point_face_[point];
    if (known == kNone) {
      known = face;
    } else {
      DisjointSets(parents_).unite(known, face);
    }
  }
}

// In the order of their first faces, which stand for their sets.
void BubbleFinder::number_pockets() {
  std::swap(face_pocket_, old_face_pocket_);
  std::swap(pockets_, old_pockets_);
  old_bubble_count_ = bubble_count_;
  old_seals_.clear();
  for (const Bubble& bubble : bubbles_) old_seals_.push_back({bubble.touched, bubble.unsealed});
  pockets_.clear();
  bubbles_.clear();
  const DisjointSets sets(parents_);
  for (std::size_t f = 0; f < parents_.size(); ++f) {
    if (!airy_[f]) {
      face_pocket_[f] = -1;
      continue;
    }
    const int root = sets.find(static_cast<int>(f));
    if (root == static_cast<int>(f)) {
      face_pocket_[f] = static_cast<int>(pockets_.size());
      pockets_.emplace_back();
      bubbles_.emplace_back();
      bubbles_.back().closed = topology_.closed[f] != 0;
      bubbles_.back().unsealed = !fresh_ && !bubbles_.back().closed && settings_.bubbles == Bubbles::kFound;
      if (old_face_pocket_[f] >= 0) pockets_.back().side = old_pockets_[old_face_pocket_[f]].side;
    } else {
      face_pocket_[f] = face_pocket_[root];
    }
  }
  bubble_count_ = static_cast<int>(pockets_.size());
}

// Bubbles that have a point in common feel each other's pressure late; kShared marks it.
void BubbleFinder::mark_points() {
  std::fill(point_pocket_.begin(), point_pocket_.end(), kNone);
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (face_pocket_[f] < 0 || topology_.closed[f]) continue;
    for (const int point : topology_.faces[f]) {
      int& pocket = point_pocket_[point];
      pocket = pocket == kNone || pocket == face_pocket_[f] ? face_pocket_[f] : kShared;
    }
  }
}

// The faces of a patch round a bubble: its air has access to them. Those between two bubbles stay without.
void BubbleFinder::add_ring() {
  mark_points();
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (airy_[f] || !reachable_[f]) continue;
    int ring = kNone;
    for (const int point : topology_.faces[f]) {
      const int pocket = point_pocket_[point];
      if (pocket == kNone || pocket == ring) continue;
      ring = ring == kNone ? pocket : kShared;
    }
    if (ring >= 0) face_pocket_[f] = ring;
  }
  mark_points();
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (airy_[f] || face_pocket_[f] < 0) continue;
    for (const int point : topology_.faces[f]) {
      if (point_pocket_[point] == kShared) face_pocket_[f] = -1;
    }
  }
}

// What touches, is wet and has no point in common with a bubble, joined by points.
void BubbleFinder::add_patches() {
  const auto in_patch = [this](int f) {
    if (f < 0 || face_pocket_[f] >= 0 || airy_[f] || !reachable_[f]) return false;
    const Triangle& face = topology_.faces[f];
    return std::all_of(face.begin(), face.end(), [this](int point) {
      return saturation_[point] >= settings_.wet && point_pocket_[point] == kNone;
    });
  };
  const DisjointSets sets(parents_);
  std::fill(point_face_.begin(), point_face_.end(), kNone);
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (in_patch(static_cast<int>(f))) join_by_points(static_cast<int>(f));
  }
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (!in_patch(static_cast<int>(f))) continue;
    const int root = sets.find(static_cast<int>(f));
    if (root != static_cast<int>(f)) {
      face_pocket_[f] = face_pocket_[root];
      continue;
    }
    face_pocket_[f] = static_cast<int>(pockets_.size());
    pockets_.emplace_back();
    bubbles_.emplace_back();
    bubbles_.back().patch = true;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
