// How the air of bubbles moves when they merge, split, vanish and come about.
#include <algorithm>
#include <cmath>

#include "bubble_finder.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Air goes with the faces: each new bubble takes K of an old one by the share of the old one's volume that
// lies under the faces they have in common. Of faces that came to touch nothing is left to carry it, so their
// share goes to the rest of the old bubble; if there is no rest, it stays on the patch, a face's share by its
// area, and is taken up by whichever bubble opens there.
void BubbleFinder::move_air() {
  const double before = air_before_moving();
  old_weight_.assign(old_pockets_.size(), 0.0);
  old_area_.assign(old_pockets_.size(), 0.0);
  const std::size_t faces = face_pocket_.size();
  const auto carried = [&](std::size_t f) {
    return std::max(old_pockets_[old_face_pocket_[f]].side * face_volume_[f], 0.0);
  };
  const auto now_of = [&](std::size_t f) { return bubble_of(static_cast<int>(f)); };
  // Area of all faces while none remains, of the remaining ones as soon as one does.
  old_children_.assign(old_pockets_.size(), 0);
  for (std::size_t f = 0; f < faces; ++f) {
    if (old_bubble_of(f) < 0 || now_of(f) < 0) continue;
    ++old_children_[old_bubble_of(f)];
    const Seal& seal = old_seals_[old_bubble_of(f)];
    Bubble& bubble = bubbles_[now_of(f)];
    bubble.touched = bubble.touched || seal.touched;
    bubble.unsealed = bubble.unsealed && seal.unsealed;
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const int old = old_bubble_of(f);
    if (old < 0) continue;
    const bool remains = now_of(f) >= 0;
    if (remains) old_weight_[old] += carried(f);
    if (remains || old_children_[old] == 0) old_area_[old] += topology_.face_areas[f];
  }
  for (std::size_t f = 0; f < faces; ++f) {
    const int old = old_bubble_of(f), now = now_of(f);
    if (old >= 0) {
      const double air = old_pockets_[old].air;
      const double by_area = topology_.face_areas[f] / old_area_[old];
      if (now >= 0) {
        pockets_[now].air += air * (old_weight_[old] > 0 ? carried(f) / old_weight_[old] : by_area);
      } else if (old_children_[old] == 0) {
        parked_[f] += air * by_area;
      }
    }
  }
  // What rounding made or lost goes to the fullest bubble.
  if (!pockets_.empty()) {
    const auto fullest =
        std::max_element(pockets_.begin(), pockets_.end(),
                         [](const AirPocket& a, const AirPocket& b) { return a.air < b.air; });
    fullest->air = std::max(fullest->air + (before - air()), 0.0);
  }
  count_changes();
}

// What rests on a patch is air at ambient pressure: a bubble that opens there takes as much as it has room
// for, frame by frame as it grows. All of it at once, in a bubble that is thin to begin with, would be an
// explosive.
void BubbleFinder::take_parked() {
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    if (parked_[f] == 0) continue;
    const int now = bubble_of(static_cast<int>(f));
    if (now < 0) continue;
    const double room = settings_.ambient * bubbles_[now].volume - pockets_[now].air;
    const double taken = std::min(parked_[f], std::max(room, 0.0));
    pockets_[now].air += taken;
    parked_[f] -= taken;
  }
}

double BubbleFinder::air_before_moving() const {
  double sum = 0;
  for (const AirPocket& pocket : old_pockets_) sum += pocket.air;
  for (const double air : parked_) sum += air;
  return sum;
}

void BubbleFinder::count_changes() {
  if (fresh_) return;
  for (int i = 0; i < old_bubble_count_; ++i) counts_.parked += old_children_[i] == 0;
  // Faces in the order of their new bubbles, so that each pair of old and new is seen once.
  order_cursor_.assign(bubble_count_ + 1, 0);
  for (const int pocket : face_pocket_) {
    if (pocket >= 0 && pocket < bubble_count_) ++order_cursor_[pocket + 1];
  }
  for (std::size_t i = 1; i < order_cursor_.size(); ++i) order_cursor_[i] += order_cursor_[i - 1];
  const int in_bubbles = order_cursor_.back();
  for (std::size_t f = 0; f < face_pocket_.size(); ++f) {
    const int now = bubble_of(static_cast<int>(f));
    if (now >= 0) face_order_[order_cursor_[now]++] = static_cast<int>(f);
  }
  seen_by_.assign(old_pockets_.size(), -1);
  std::fill(old_children_.begin(), old_children_.end(), 0);
  for (int i = 0; i < in_bubbles;) {
    const int now = face_pocket_[face_order_[i]];
    int parents = 0;
    for (; i < in_bubbles && face_pocket_[face_order_[i]] == now; ++i) {
      const int old = old_bubble_of(face_order_[i]);
      if (old < 0 || seen_by_[old] == now) continue;
      seen_by_[old] = now;
      ++parents;
      ++old_children_[old];
    }
    counts_.born += parents == 0;
    counts_.merged += std::max(parents - 1, 0);
  }
  for (const int children : old_children_) counts_.split += std::max(children - 1, 0);
}

// The air of the first frame: what lies under the cloth, at ambient pressure, or as much as is asked for,
// shared by volume. Without any volume it rests on the cloth's faces.
void BubbleFinder::first_air() {
  double volume = 0;
  for (int i = 0; i < bubble_count_; ++i) volume += std::max(bubbles_[i].volume, 0.0);
  const bool first = !started_;
  started_ = true;
  double made = 0;
  for (int i = 0; i < bubble_count_; ++i) {
    const double share = std::max(bubbles_[i].volume, 0.0);
    double air = settings_.ambient * share;
    if (first && settings_.initial_volume) {
      air = volume > 0 ? settings_.ambient * *settings_.initial_volume * (share / volume) : 0.0;
    }
    pockets_[i].air = air;
    made += air;
  }
  if (first && settings_.initial_volume && volume == 0) {
    double area = 0;
    for (std::size_t f = 0; f < parked_.size(); ++f)
      area += topology_.closed[f] ? 0 : topology_.face_areas[f];
    const double air = area > 0 ? settings_.ambient * *settings_.initial_volume : 0.0;
    for (std::size_t f = 0; f < parked_.size(); ++f) {
      if (topology_.closed[f]) continue;
      const double share = air * (topology_.face_areas[f] / area);
      const int bubble = bubble_of(static_cast<int>(f));
      if (bubble >= 0 && settings_.bubbles == Bubbles::kOne) {
        pockets_[bubble].air += share;
      } else {
        parked_[f] = share;
      }
    }
    made += air;
  }
  // The atmosphere gave what is there after a dry spell.
  if (first) {
    total_ = made;
  } else {
    vented_ -= made;
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
