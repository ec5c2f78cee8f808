#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "cloth_scene.h"
#include "paper_cloth.h"
#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"

// The `paper` mode as a body of a Bullet world.
namespace softpoint::cloth {
namespace {

ClothDesign paper_design() {
  ClothDesign design = sheet(15, 0.1);
  design.air = thesis_air(30e-6);
  design.saturation.assign(design.pattern.points.size(), 1.0);
  design.wetness.capacity = 0;
  design.paper = reference_paper_settings(5e-6);
  design.fabric.damping_time = 5e-6;
  return design;
}

TEST(PaperBody, DoesInAWorldWhatItDoesAlone) {
  const double height = 0.004;
  const ClothDesign design = paper_design();
  OverFloor scene(design, height);
  PaperCloth alone(design.pattern, design.fabric, *design.paper);
  const double half = 0.5 * design.fabric.thickness;
  alone.set_plane(Vec3::UnitY(), {0, half, 0});
  alone.set_state(scene.cloth.points(), scene.cloth.velocities());
  const btVector3 g = scene.world->getGravity();
  alone.set_gravity(Vec3(g.x(), g.y(), g.z()));
  alone.set_air(30e-6);
  alone.set_friction(scene.cloth.getFriction() * scene.floor.getFriction());
  const int middle = 7 * 15 + 7;
  const Vec3 start = scene.cloth.points()[middle];
  const HandleId hand =
      scene.system.grab(scene.cloth, middle, start, std::numeric_limits<double>::infinity());
  for (int k = 1; k <= 12; ++k) {
    const double lift = k < 4 ? 0 : 0.0005 * (k - 3), speed = k < 4 ? 0 : 0.0005 * 60;
    scene.system.move(hand, start + Vec3(0, lift, 0));
    scene.world->stepSimulation(btScalar(1.0 / 60), 1, btScalar(1.0 / 60));
    alone.set_hands(std::vector<PaperHand>{{middle, start + Vec3(0, lift, 0), Vec3(0, speed, 0)}});
    alone.step(double(btScalar(1.0 / 60)));
  }
  EXPECT_NEAR(scene.cloth.points()[middle].y(), start.y() + 0.0005 * 9, 1e-9);
  EXPECT_LT(scene.cloth.points()[0].y(), height - 1e-3);  // the rim sank, the air holds the rest
  ASSERT_EQ(scene.cloth.bubbles().size(), 1u);
  EXPECT_NEAR(scene.cloth.bubbles()[0].volume, alone.volume(), 1e-3 * alone.volume());
  EXPECT_NEAR(scene.cloth.bubbles()[0].pressure, 101325 + alone.gauge(), 3);
  double apart = 0;
  for (int v = 0; v < alone.point_count(); ++v) {
    apart = std::max(apart, (scene.cloth.points()[v] - alone.positions()[v]).norm());
  }
  EXPECT_LT(apart, 1e-4);
  EXPECT_GT(scene.cloth.profile().counts.substeps, 3000);
  EXPECT_EQ(scene.cloth.guard_fired(), 0);
}

TEST(PaperBody, RefusesWhatIsNoSheetOfAGrid) {
  ClothDesign design = paper_design();
  design.pattern = mesh_pattern(softpoint::sphere(0.1, 1), design.fabric);
  design.saturation.clear();
  EXPECT_THROW(Cloth{design}, Error);
}

}  // namespace
}  // namespace softpoint::cloth
