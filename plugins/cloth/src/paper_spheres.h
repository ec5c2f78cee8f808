#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "softpoint/cloth/pattern.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Self-collision of the `paper` mode: points as spheres, those next to each other in the grid left out. Pairs
// that may meet are looked up anew whenever some point has gone half the margin.
class PaperSpheres {
 public:
  PaperSpheres(int columns, int rows, double diameter, double friction)
      : columns_(columns), rows_(rows), diameter_(diameter), margin_(0.5 * diameter), friction_(friction) {}

  bool wanted() const { return diameter_ > 0; }
  int pair_count() const { return static_cast<int>(pairs_.size()); }

  // `body` gives and takes position(i), velocity(i), set_velocity(i, v); all masses count as equal.
  template <class Body>
  void collide(Body& body, double h) {
    if (moved_far(body, h)) find_pairs(body);
    for (const auto& [a, b] : pairs_) {
      const Vec3 va = body.velocity(a), vb = body.velocity(b);
      const Vec3 arm = body.position(b) + h * vb - body.position(a) - h * va;  // at the end of the step
      const double distance = arm.norm();
      if (distance >= diameter_ || distance <= 0) continue;
      const Vec3 n = arm / distance;
      const double push = 0.5 * (diameter_ - distance) / h;  // speed each takes up
      const Vec3 slip = (vb - va) - n * n.dot(vb - va);
      const double speed = slip.norm();
      const double grip = speed > 0 ? std::min(0.5 * speed, friction_ * push) / speed : 0.0;
      body.set_velocity(a, va - push * n + grip * slip);
      body.set_velocity(b, vb + push * n - grip * slip);
    }
  }

 private:
  template <class Body>
  bool moved_far(const Body& body, double h) const {
    const int n = columns_ * rows_;
    if (static_cast<int>(known_.size()) != n) return true;
    const double limit = 0.25 * margin_ * margin_;
    for (int i = 0; i < n; ++i) {
      if (!((body.position(i) + h * body.velocity(i) - known_[static_cast<std::size_t>(i)]).squaredNorm() <
            limit))
        return true;
    }
    return false;
  }

  // Those who fly farther out than integers reach share the last cell.
  static std::int64_t cell(double x) {
    constexpr double kLast = 1e15;
    return static_cast<std::int64_t>(std::floor(x > -kLast ? std::min(x, kLast) : -kLast));
  }

  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return (static_cast<std::uint64_t>(x) * 73856093u) ^ (static_cast<std::uint64_t>(y) * 19349663u) ^
           (static_cast<std::uint64_t>(z) * 83492791u);
  }

  bool next_to_each_other(int a, int b) const {
    return std::abs(a % columns_ - b % columns_) <= 1 && std::abs(a / columns_ - b / columns_) <= 1;
  }

  template <class Body>
  void find_pairs(const Body& body) {
    const double reach = diameter_ + margin_;
    const int n = columns_ * rows_;
    known_.resize(static_cast<std::size_t>(n));
    pairs_.clear();
    cells_.clear();
    for (int i = 0; i < n; ++i) {
      const Vec3 p = body.position(i);
      known_[static_cast<std::size_t>(i)] = p;
      const std::int64_t cx = cell(p.x() / reach), cy = cell(p.y() / reach), cz = cell(p.z() / reach);
      for (std::int64_t dx = -1; dx <= 1; ++dx) {
        for (std::int64_t dy = -1; dy <= 1; ++dy) {
          for (std::int64_t dz = -1; dz <= 1; ++dz) {
            const auto found = cells_.find(key(cx + dx, cy + dy, cz + dz));
            if (found == cells_.end()) continue;
            for (int other : found->second) {
              if (next_to_each_other(i, other)) continue;
              if ((known_[static_cast<std::size_t>(other)] - p).squaredNorm() < reach * reach) {
                pairs_.push_back({other, i});
              }
            }
          }
        }
      }
      cells_[key(cx, cy, cz)].push_back(i);
    }
    std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
  }

  int columns_, rows_;
  double diameter_, margin_, friction_;
  std::vector<Vec3> known_;
  std::vector<std::array<int, 2>> pairs_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
