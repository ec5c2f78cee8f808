// A wet sheet falls on a floor, lies there and is lifted by its middle.
#include <cmath>

#include "app.h"
#include "softpoint/cloth/cloth.h"
#include "softpoint/core/deformable_system.h"

int main() {
  namespace cloth = softpoint::cloth;
  cloth::ClothDesign design;
  design.pattern = cloth::square_pattern(21, 21, 0.3, 0.3, design.fabric);
  design.saturation.assign(design.pattern.points.size(), 1.0);
  softpoint::Mat3 lying;  // patterns lie in x, y; here y is up
  lying << 1, 0, 0, 0, 0, 1, 0, -1, 0;

  World scene;
  softpoint::DeformableSystem soft(scene.world);
  cloth::Cloth sheet(design, {0, 0.02, 0}, lying);
  soft.add(sheet);
  scene.step(60);

  double lowest = 1, highest = -1, push = 0;
  for (const softpoint::Vec3& point : sheet.points()) {
    lowest = std::min(lowest, point.y());
    highest = std::max(highest, point.y());
  }
  for (const softpoint::Vec3& force : sheet.contact_forces()) push += force.y();
  std::printf("lies at %.6f to %.6f m, push of the floor %.6f N, weight %.6f N\n", lowest, highest, push,
              9.81 * sheet.total_mass());
  require(lowest > -2e-4 && highest < 0.02, "the sheet lies on the floor");

  const int middle = 10 * 21 + 10;
  const softpoint::Vec3 from = sheet.points()[middle];
  const softpoint::HandleId hand = soft.grab(sheet, middle, from);
  for (int i = 1; i <= 30; ++i) {
    soft.move(hand, from + softpoint::Vec3(0, 0.05 * i / 30.0, 0));
    scene.step(1);
  }
  std::printf("held at %.6f m with %.6f N, stretched by %.4f at most\n", sheet.points()[middle].y(),
              soft.handle_force(hand).y(), sheet.stretch().largest);
  require(std::abs(sheet.points()[middle].y() - from.y() - 0.05) < 1e-3, "the hand holds its point");
  require(sheet.guard_fired() == 0, "no guard fired");

  require_refusal([&] { cloth::square_pattern(1, 2, 1, 1, design.fabric); }, "columns = 1");
}
