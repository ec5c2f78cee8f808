// The search for bubbles takes nothing from the heap, from its first frame on. An executable of its own: it
// replaces operator new.
#include <gtest/gtest.h>

#include <random>

#include "air_sheet.h"
#include "support/counted_malloc.h"

namespace softpoint::cloth {
namespace {

TEST(Bubbles, TakeNothingFromTheHeap) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  AirSettings settings;
  settings.lifetime = 1;
  AirSheet sheet(settings, 30, 0.3, 0.8);
  std::vector<double> volumes(sheet.pattern.faces.size(), 0.0);
  std::vector<double> gauges(sheet.pattern.faces.size(), 5.0);
  std::vector<Vec3> forces(sheet.positions.size(), Vec3::Zero());
  int most = 0;
  const long long before = test::heap_calls;
  for (int frame = 0; frame < 300; ++frame) {
    const double share = frame % 50 == 0 ? 2.0 : uniform(random);  // now and then all of it flies
    for (std::size_t i = 0; i < sheet.positions.size(); ++i) {
      sheet.positions[i] = sheet.pattern.points[i];
      sheet.positions[i].z() = uniform(random) > share ? 0.0 : 0.02 * uniform(random);
      sheet.feet[i] = Vec3(sheet.positions[i].x(), sheet.positions[i].y(), 0);
      sheet.gaps[i] = sheet.positions[i].z();
    }
    sheet.find();
    most = std::max(most, sheet.pockets());
    for (int i = 0; i < sheet.pockets(); ++i) volumes[i] = sheet.volume(i);
    sheet.finder.exchange(1.0 / 60, {volumes.data(), sheet.finder.pockets().size()});
    sheet.finder.add_foot_forces(sheet.frame(), gauges, forces);
    if (frame % 10 == 0) sheet.finder.set_saturation(sheet.saturations);
  }
  EXPECT_EQ(test::heap_calls - before, 0);
  EXPECT_GT(most, 10);
}

}  // namespace
}  // namespace softpoint::cloth
