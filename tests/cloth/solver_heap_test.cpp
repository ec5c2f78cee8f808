// Steps of the solver take nothing from the heap once warm: the other half of the executable of
// air_heap_test.cpp, which counts.
#include <gtest/gtest.h>

#include <vector>

#include "cloth_solver.h"
#include "support/counted_heap_calls.h"

namespace softpoint::cloth {
namespace {

TEST(ClothSolver, TakesNothingFromTheHeapOnceWarm) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    Fabric fabric;
    fabric.bending_stiffness = 1e-5;
    const ClothPattern pattern = square_pattern(21, 21, 0.12, 0.12, fabric);
    ClothSettings settings;
    settings.precision = precision;
    ClothSolver solver(pattern, fabric, settings);
    solver.set_gravity({0, 0, -9.8});
    std::vector<PointContacts> floor(pattern.points.size());
    for (PointContacts& c : floor)
      c.count = 1, c.planes[0].foot = Vec3(0, 0, -0.01), c.planes[0].friction = 0.3;
    for (int i = 0; i < 21; ++i) {  // some meet two planes
      floor[i].count = 2, floor[i].planes[1] = floor[i].planes[0];
      floor[i].planes[1].normal = Vec3::UnitY(), floor[i].planes[1].foot = Vec3(0, -0.0605, 0);
    }
    const std::vector<int> faces(pattern.faces.size(), 0);
    std::vector<RimQuad> rims;
    for (int i = 0; i < 20; ++i) rims.push_back({0, i, i + 1, pattern.points[i], pattern.points[i + 1]});
    AirPocket pocket;
    pocket.closure = 2e-4;
    pocket.air = pocket.ambient * pocket.closure;
    long long before = 0;
    for (int frame = 1; frame <= 60; ++frame) {
      if (frame == 3) before = test::heap_calls;
      const ClothHand hands[2] = {{220, pattern.points[220] + Vec3(0, 0, 0.001 * frame), Vec3(0, 0, 0.06)},
                                  {240, pattern.points[240], Vec3::Zero(), 0.5}};
      solver.set_contacts(floor);
      solver.set_hands(hands);
      solver.set_air(faces, {&pocket, 1}, rims);
      solver.step(1.0 / 60);
    }
    EXPECT_EQ(test::heap_calls - before, 0);
    EXPECT_GT(solver.profile().coarse_steps, 100);
    EXPECT_GT(solver.profile().boyle_solves, 100);
  }
}

}  // namespace
}  // namespace softpoint::cloth
