#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "bubble_finder.h"
#include "softpoint/cloth/pattern.h"

namespace softpoint::cloth {

// The nearest point of a solid and the normal there.
struct Foot {
  Vec3 point;
  Vec3 normal;
  double gap;
};
using Nearest = std::function<Foot(const Vec3&)>;

inline Foot foot_on_plane(const Vec3& x) { return {{x.x(), x.y(), 0}, Vec3::UnitZ(), x.z()}; }

// A square sheet and the finder of its bubbles, moved by hand.
struct AirSheet {
  explicit AirSheet(const AirSettings& settings = {}, int points = 50, double side = 0.3,
                    double saturation = 1)
      : pattern(square_pattern(points, points, side, side, Fabric{})),
        finder(make_air_topology(pattern.points, pattern.faces), settings),
        positions(pattern.points),
        saturations(pattern.points.size(), saturation) {
    finder.set_saturation(saturations);
    measure(foot_on_plane);
  }

  void measure(const Nearest& nearest) {
    feet.resize(positions.size());
    normals.resize(positions.size());
    gaps.resize(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Foot foot = nearest(positions[i]);
      feet[i] = foot.point;
      normals[i] = foot.normal;
      gaps[i] = foot.gap;
    }
  }

  // Heights over the plane z = 0 at each point of the sheet as cut.
  void lift(const std::function<double(double, double)>& height) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = pattern.points[i];
      positions[i].z() = height(positions[i].x(), positions[i].y());
    }
    measure(foot_on_plane);
  }

  AirFrame frame() const { return {positions, feet, normals, gaps}; }
  bool find() { return finder.find(frame()); }
  void find(int frames) {
    for (int i = 0; i < frames; ++i) find();
  }
  // Bubbles; contact patches come after them.
  int pockets() const {
    int count = 0;
    for (const Bubble& bubble : finder.bubbles()) count += !bubble.patch;
    return count;
  }
  double air(int pocket) const { return finder.pockets()[pocket].air; }
  double volume(int pocket) const { return finder.volume(pocket, positions); }
  std::vector<double> volumes() const {
    std::vector<double> all;
    for (std::size_t i = 0; i < finder.pockets().size(); ++i) all.push_back(volume(static_cast<int>(i)));
    return all;
  }
  void exchange(double dt) { finder.exchange(dt, volumes()); }

  ClothPattern pattern;
  BubbleFinder finder;
  std::vector<Vec3> positions, feet, normals;
  std::vector<double> gaps, saturations;
};

// A smooth bump of this height, zero from `radius` on.
inline double bump(double x, double y, double height, double radius) {
  const double s = 1 - (x * x + y * y) / (radius * radius);
  return s > 0 ? height * s * s : 0.0;
}

// No limit, leak, vent or film: K changes by nothing but the bubbles themselves.
inline AirSettings sealed() {
  AirSettings settings;
  settings.patch_suction = settings.limit_suction = settings.leak = settings.vent = settings.adhesion = false;
  return settings;
}

}  // namespace softpoint::cloth
