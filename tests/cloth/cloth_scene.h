#pragma once

#include <algorithm>
#include <memory>

#include "softpoint/cloth/cloth.h"
#include "softpoint/core/deformable_system.h"
#include "support/worlds.h"

namespace softpoint::cloth {

// Patterns lie in x, y; worlds here have y up.
inline Mat3 lying() {
  Mat3 turn;
  turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return turn;
}

// A square sheet, by default of 15 x 15 points and 0.3 m, 60 g dry.
inline ClothDesign sheet(int points = 15, double side = 0.3) {
  ClothDesign design;
  design.pattern = square_pattern(points, points, side, side, design.fabric);
  return design;
}

inline double lowest(const Cloth& cloth) {
  double low = 1e30;
  for (const Vec3& p : cloth.points()) {
    low = std::min(low, p.y());
  }
  return low;
}

inline Vec3 sum(std::span<const Vec3> vectors) {
  Vec3 total = Vec3::Zero();
  for (const Vec3& v : vectors) {
    total += v;
  }
  return total;
}

// A sheet over a floor.
struct OverFloor {
  explicit OverFloor(const ClothDesign& design = sheet(), double height = 0.00015, const Mat3& turn = lying())
      : system(*world), floor(world.add_floor()), cloth(design, Vec3(0, height, 0), turn) {
    system.add(cloth);
  }
  TestWorld world;
  DeformableSystem system;
  btRigidBody& floor;
  Cloth cloth;
};

}  // namespace softpoint::cloth
