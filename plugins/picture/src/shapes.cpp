#include "shapes.h"

#include <cmath>

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

constexpr double kPi = 3.14159265358979323846;

// A surface of revolution under construction, built from the top ring downwards.
class Lathe {
 public:
  explicit Lathe(int around) : around_(around) {}

  int tip(double y) {
    mesh_.vertices.push_back({0, y, 0});
    return mesh_.vertex_count() - 1;
  }
  int ring(double radius, double y) {
    for (int i = 0; i < around_; ++i) {
      const double angle = 2 * kPi * i / around_;
      mesh_.vertices.push_back({radius * std::cos(angle), y, -radius * std::sin(angle)});
    }
    return mesh_.vertex_count() - around_;
  }
  void fan_above(int top, int ring) {
    for (int i = 0; i < around_; ++i) mesh_.triangles.push_back({top, ring + i, ring + next(i)});
  }
  void fan_below(int ring, int bottom) {
    for (int i = 0; i < around_; ++i) mesh_.triangles.push_back({bottom, ring + next(i), ring + i});
  }
  void band(int upper, int lower) {
    for (int i = 0; i < around_; ++i) {
      mesh_.triangles.push_back({upper + i, lower + i, lower + next(i)});
      mesh_.triangles.push_back({upper + i, lower + next(i), upper + next(i)});
    }
  }
  TriangleMesh take() { return std::move(mesh_); }

 private:
  int next(int i) const { return (i + 1) % around_; }

  int around_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh unit_box() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({(i & 1) ? 1.0 : -1.0, (i & 2) ? 1.0 : -1.0, (i & 4) ? 1.0 : -1.0});
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh unit_sphere(int around, int along) { return capsule(1.0, 0.0, around, along); }

TriangleMesh unit_cylinder(int around) {
  Lathe lathe(around);
  const int top = lathe.tip(1), upper = lathe.ring(1, 1), lower = lathe.ring(1, -1), bottom = lathe.tip(-1);
  lathe.fan_above(top, upper);
  lathe.band(upper, lower);
  lathe.fan_below(lower, bottom);
  return lathe.take();
}

TriangleMesh unit_cone(int around) {
  Lathe lathe(around);
  const int top = lathe.tip(1), lower = lathe.ring(1, -1), bottom = lathe.tip(-1);
  lathe.fan_above(top, lower);
  lathe.fan_below(lower, bottom);
  return lathe.take();
}

TriangleMesh capsule(double radius, double half_length, int around, int along) {
  Lathe lathe(around);
  int previous = lathe.tip(half_length + radius);
  bool first = true;
  const auto add_ring = [&](double angle, double shift) {
    const int ring = lathe.ring(radius * std::sin(angle), radius * std::cos(angle) + shift);
    if (first) {
      lathe.fan_above(previous, ring);
    } else {
      lathe.band(previous, ring);
    }
    first = false;
    previous = ring;
  };
  const int half = along / 2;
  for (int i = 1; i <= half; ++i) add_ring(0.5 * kPi * i / half, half_length);
  if (half_length > 0) add_ring(0.5 * kPi, -half_length);
  for (int i = half - 1; i >= 1; --i) add_ring(kPi - 0.5 * kPi * i / half, -half_length);
  lathe.fan_below(previous, lathe.tip(-half_length - radius));
  return lathe.take();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
