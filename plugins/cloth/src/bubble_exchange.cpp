// What bubbles exchange with the atmosphere, and where all air is.
#include <algorithm>
#include <cmath>

#include "bubble_finder.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

void BubbleFinder::exchange(double dt, std::span<const double> volumes) {
  if (pockets_.empty()) return;
  const double ambient = settings_.ambient;
  for (std::size_t i = 0; i < pockets_.size(); ++i) {
    AirPocket& pocket = pockets_[i];
    const Bubble& bubble = bubbles_[i];
    const double volume = volumes[i];
    if (bubble.patch || bubble.thin) continue;
    if (pocket.open) {
      vent(static_cast<int>(i), pocket.air - ambient * std::max(volume, 0.0));
      continue;
    }
    if (!(volume > 0)) continue;
    // Air that burst through the pores within the frame, while suction stood at its limit.
    const double least = std::max(ambient - pocket.max_suction, 0.0) * volume;
    if (pocket.air < least) vent(static_cast<int>(i), pocket.air - least);
    // And air that burst out under the rim, while it stood at what that can hold.
    const double most = (ambient + pocket.max_gauge) * volume;
    if (pocket.air > most) vent(static_cast<int>(i), pocket.air - most);
    openings_.clear();
    if (settings_.leak) {
      openings_.push_back({bubble.open_weave, 0});
      openings_.push_back({bubble.wet_weave, bubble_point(settings_)});
    }
    for (int r = bubble.rim_begin; settings_.vent && r < rim_end(static_cast<int>(i)); ++r) {
      const Rim& rim = rim_list_[r];
      if (!rim.free) continue;
      const AirTopology::Edge& edge = topology_.edges[rim.edge];
      const double gap = std::max(rim.gap, settings_.film_gap);
      const bool film =
          rim.gap <= settings_.bridge_gap && (saturation_[edge.a] + saturation_[edge.b]) / 2 >= settings_.wet;
      openings_.push_back({edge.length * gap * gap * gap / (12 * settings_.viscosity * settings_.rim_width),
                           film ? film_pressure(settings_, rim.gap) : 0.0});
    }
    const double after = air_after_leak(pocket.air, volume, dt, ambient, pocket.min_pressure,
                                        {openings_.data(), openings_.size()});
    vent(static_cast<int>(i), pocket.air - after);
  }
}

void BubbleFinder::vent(int pocket, double air) {
  pockets_[pocket].air -= air;
  const double sum = vented_ + air;
  vented_rest_ += std::abs(vented_) >= std::abs(air) ? (vented_ - sum) + air : (air - sum) + vented_;
  vented_ = sum;
}

void BubbleFinder::drop_all() {
  if (fresh_) return;
  for (std::size_t i = 0; i < pockets_.size(); ++i) vent(static_cast<int>(i), pockets_[i].air);
  const double rest = air();  // at rest on patches
  vented_ += rest;
  std::fill(parked_.begin(), parked_.end(), 0.0);
  std::fill(face_pocket_.begin(), face_pocket_.end(), -1);
  std::fill(adhesion_.begin(), adhesion_.end(), 0.0);
  std::fill(airy_.begin(), airy_.end(), 0);
  pockets_.clear();
  bubbles_.clear();
  bubble_count_ = 0;
  rims_.clear();
  rim_list_.clear();
  fresh_ = true;
}

double BubbleFinder::vented() const { return vented_ + vented_rest_; }

double BubbleFinder::air() const {
  double sum = 0;
  for (const AirPocket& pocket : pockets_) sum += pocket.air;
  for (const double air : parked_) sum += air;
  return sum;
}

double BubbleFinder::audit() const { return air() + vented() - total_; }

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
