#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "softpoint/core/shapes.h"
#include "softpoint/core/triangle_mesh.h"

// Bars of equal cylinders (the elastic-character paper's: 16-gon prisms of 82 vertices) in a row along z,
// which share their interfaces: one bar seen from outside.
namespace softpoint::reference {

inline constexpr int kSides = 16;
inline constexpr double kRadius = 0.5;      // m, circumscribed
inline constexpr double kPartLength = 1.0;  // m

// 64 N + 18 vertices, 128 N + 32 triangles; z from -N/2 to N/2 part lengths.
inline TriangleMesh bar_mesh(int parts) { return prism(kSides, 4 * parts, 1, kRadius, parts * kPartLength); }

// The same solid for references: every edge of the 16-gon in `level` pieces, caps of `level` rings, and
// layers along z that become thin towards the clamped caps, where the stress is singular at the rim. Levels
// of one family differ by their size alone, so that answers can be extrapolated.
struct RefinedBar {
  TriangleMesh mesh;
  std::vector<int> bottom, top;  // vertices of the caps
};

// Heights of the layers, from one cap to the other: `level` times 4 graded ones in the first and last
// diameter, and layers of half a diameter over `level` between.
inline std::vector<double> refined_heights(int parts, int level) {
  const double length = parts * kPartLength, zone = std::min(2.0 * kRadius, 0.5 * length);
  const int graded = 4 * level,
            middle = static_cast<int>(std::lround((length - 2.0 * zone) / kRadius)) * level;
  std::vector<double> z;
  for (int i = 0; i < graded; ++i) z.push_back(zone * std::pow(static_cast<double>(i) / graded, 1.5));
  for (int i = 0; i <= middle; ++i)
    z.push_back(zone + (length - 2.0 * zone) * (middle ? 1.0 * i / middle : 0.0));
  for (int i = graded - 1; i >= 0; --i) z.push_back(length - z[i]);
  for (double& h : z) h -= 0.5 * length;
  return z;
}

inline RefinedBar refined_bar(int parts, int level) {
  const int around = kSides * level;
  std::vector<Vec3> outline;  // of radius 1
  for (int k = 0; k < around; ++k) {
    const double a = 2.0 * M_PI / kSides * (k / level), b = 2.0 * M_PI / kSides * (k / level + 1);
    const double t = static_cast<double>(k % level) / level;
    outline.emplace_back((1 - t) * std::cos(a) + t * std::cos(b), (1 - t) * std::sin(a) + t * std::sin(b),
                         0.0);
  }
  struct Ring {
    double scale, z;
  };
  std::vector<Ring> rings;
  const std::vector<double> z = refined_heights(parts, level);
  const auto cap_scale = [&](int i) { return 1.0 - std::pow(1.0 - static_cast<double>(i) / level, 1.5); };
  for (int i = 1; i < level; ++i) rings.push_back({cap_scale(i), z.front()});
  for (double h : z) rings.push_back({1.0, h});
  for (int i = level - 1; i >= 1; --i) rings.push_back({cap_scale(i), z.back()});

  RefinedBar bar;
  TriangleMesh& mesh = bar.mesh;
  mesh.vertices.emplace_back(0.0, 0.0, z.front());
  for (const Ring& ring : rings) {
    for (const Vec3& p : outline) {
      mesh.vertices.push_back(kRadius * ring.scale * p + Vec3(0.0, 0.0, ring.z));
    }
  }
  mesh.vertices.emplace_back(0.0, 0.0, z.back());
  const int last = mesh.vertex_count() - 1, count = static_cast<int>(rings.size());
  const auto at = [around](int r, int k) { return 1 + r * around + k % around; };
  for (int k = 0; k < around; ++k) {
    mesh.triangles.push_back({0, at(0, k + 1), at(0, k)});
    for (int r = 0; r + 1 < count; ++r) {
      const int a = at(r, k), b = at(r, k + 1), c = at(r + 1, k + 1), d = at(r + 1, k);
      if ((k + r) % 2 == 0) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
      } else {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({b, c, d});
      }
    }
    mesh.triangles.push_back({last, at(count - 1, k), at(count - 1, k + 1)});
  }
  for (int v = 0; v <= last; ++v) {
    if (mesh.vertices[v].z() == z.front()) bar.bottom.push_back(v);
    if (mesh.vertices[v].z() == z.back()) bar.top.push_back(v);
  }
  return bar;
}

}  // namespace softpoint::reference
