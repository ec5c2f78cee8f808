#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "cloth_solver.h"

// The reference runs' scene (data/*.csv): 50 x 50 points over z = 0 with V0 below, the centre lifted by a
// smooth step.
namespace softpoint::cloth::lift {

struct Row {
  double time, volume, pressure, force, largest, p99, mean, top, bottom;  // s, cm3, kPa, N, -, -, -, m, m
};

inline std::vector<Row> read_rows(const std::string& name) {
  std::ifstream in(std::string(SOFTPOINT_CLOTH_DATA) + "/" + name);
  std::vector<Row> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::stringstream text(line);
    std::vector<double> v;
    for (std::string cell; std::getline(text, cell, ',');) v.push_back(std::stod(cell));
    rows.push_back({v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9]});
  }
  EXPECT_GT(rows.size(), 1u) << name;
  return rows;
}

inline Fabric fabric() {
  Fabric f;  // the defaults are those of the reference runs
  f.area_density = 0.2, f.warp_stiffness = f.weft_stiffness = 1e4, f.shear_stiffness = 2.5e3;
  f.compression_ratio = 0.05, f.damping_time = 1e-4, f.drag_rate = 1;
  return f;
}

// Vertical walls from the border down to z = 0.
inline void border_walls(const ClothPattern& p, const std::vector<Vec3>& x, std::vector<RimQuad>& out) {
  out.clear();
  const auto add = [&](int a, int b) {
    out.push_back({0, a, b, {x[a].x(), x[a].y(), 0}, {x[b].x(), x[b].y(), 0}});
  };
  const int n = p.columns, m = p.rows;
  for (int i = 0; i + 1 < n; ++i) add(i, i + 1), add((m - 1) * n + i + 1, (m - 1) * n + i);
  for (int j = 0; j + 1 < m; ++j) add(j * n + n - 1, (j + 1) * n + n - 1), add((j + 1) * n, j * n);
}

class Lift {
 public:
  Lift(const ClothSettings& settings, double volume_cm3, double height, double seconds, int points = 50)
      : pattern_(square_pattern(points, points, 0.3, 0.3, fabric(), Lumping::kEqual)),
        solver_(pattern_, fabric(), settings),
        height_(height),
        seconds_(seconds) {
    x_ = pattern_.points;
    for (Vec3& p : x_) p.z() = volume_cm3 * 1e-6 / 0.09;
    solver_.set_positions(x_);
    solver_.set_gravity({0, 0, -9.8});
    std::vector<PointContacts> contacts(x_.size());
    for (PointContacts& c : contacts) c.count = 1, c.planes[0].friction = 0.4;
    solver_.set_contacts(contacts);
    pockets_[0].air = pockets_[0].ambient * volume_cm3 * 1e-6;
    face_pocket_.assign(pattern_.faces.size(), 0);
    hands_[0].point = points / 2 * points + points / 2;
    start_ = hands_[0].target = x_[hands_[0].point];
    solver_.set_hands(hands_);
  }

  // The next frame of 1/60 s.
  Row step() {
    const double time = ++frame_ / 60.0, s = std::min(1.0, time / seconds_);
    hands_[0].target = start_ + Vec3(0, 0, height_ * s * s * (3 - 2 * s));
    hands_[0].velocity = Vec3(0, 0, s < 1 ? height_ * 6 * s * (1 - s) / seconds_ : 0);
    solver_.set_hands(hands_);
    border_walls(pattern_, x_, walls_);
    solver_.set_air(face_pocket_, pockets_, walls_);
    solver_.step(1.0 / 60);
    solver_.positions(x_);
    std::vector<double> stretch;
    double sum = 0;
    for (const Spring& spring : pattern_.springs) {
      if (spring.kind == SpringKind::kShear) continue;
      stretch.push_back((x_[spring.b] - x_[spring.a]).norm() / spring.rest - 1);
      sum += std::abs(stretch.back());
    }
    const auto at = stretch.begin() + static_cast<long>(0.99 * static_cast<double>(stretch.size()));
    std::nth_element(stretch.begin(), at, stretch.end());
    const PocketState& pocket = solver_.pockets()[0];
    double top = -1, bottom = 1;
    for (const Vec3& p : x_) top = std::max(top, p.z()), bottom = std::min(bottom, p.z());
    return {time,
            pocket.volume * 1e6,
            (pockets_[0].ambient + pocket.gauge) / 1e3,
            solver_.hand_force(0).z(),
            *std::max_element(at, stretch.end()),
            *at,
            sum / static_cast<double>(stretch.size()),
            top,
            bottom};
  }

  ClothSolver& solver() { return solver_; }
  const std::vector<Vec3>& positions() const { return x_; }

 private:
  ClothPattern pattern_;
  ClothSolver solver_;
  double height_, seconds_;
  int frame_ = 0;
  Vec3 start_ = Vec3::Zero();
  std::vector<Vec3> x_;
  std::vector<AirPocket> pockets_ = std::vector<AirPocket>(1);
  std::vector<int> face_pocket_;
  std::vector<RimQuad> walls_;
  std::vector<ClothHand> hands_ = std::vector<ClothHand>(1);
};

}  // namespace softpoint::cloth::lift
