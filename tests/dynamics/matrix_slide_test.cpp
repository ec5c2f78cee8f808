// Every kind of shape in every world as a slope, and as what slides: friction holds at 0.99 of the angle of
// friction and lets go at 1.01 of it.
#include <gtest/gtest.h>

#include <cmath>

#include "support/matrix_scene.h"

namespace softpoint {
namespace {

constexpr double kFriction = 0.5;
constexpr double kDrift = 1e-4;  // m/s at rest
constexpr double kStiff = 1e7;   // Pa
constexpr double kLaw = 0.06;    // of the acceleration by Coulomb's law, 1 % above the angle
constexpr double kGravity = 9.81;

// Mean acceleration (m/s^2) by the law on a slope.
double by_law(double angle) { return kGravity * (std::sin(angle) - kFriction * std::cos(angle)); }

struct Motion {
  double drift = 0;         // m/s along the slope, mean over the last part
  double acceleration = 0;  // m/s^2, likewise
};

// Steps until things have settled, then measures what `place` (m) and `speed` (m/s) tell.
template <class Place, class Speed>
Motion measure(MatrixScene& scene, Place place, Speed speed) {
  constexpr int kSettle = 60, kWatched = 60;
  scene.world.step(kSettle);
  const double x = place(), v = speed();
  scene.world.step(kWatched);
  return {(place() - x) * 60 / kWatched, (speed() - v) * 60 / kWatched};
}

// An elastic block on the kind as ground.
Motion slide_on(const Cell& cell, double angle) {
  MatrixScene scene(cell.world);
  scene.put_ground(cell.kind, Ground::flat, kStiff);
  const auto block = place_above(scene, Shape::block, kStiff, Vec3(-0.2, 0, 0.01), 1e-3, Mat3::Identity());
  block->setFriction(kFriction);
  if (scene.slab) scene.slab->setFriction(1);
  if (scene.thing.object != nullptr) scene.thing.object->setFriction(1);
  scene.system->add(*block);
  scene.tilt(angle);
  return measure(
      scene, [&] { return block->center_of_mass().x(); },
      [&] { return block->momentum().x() / block->total_mass(); });
}

// The kind, kept from turning, on a slab whose bottom is pinned.
Motion slide_of(const Cell& cell, double angle) {
  MatrixScene scene(cell.world);
  scene.put_slab(kStiff);
  scene.slab->setFriction(kFriction);
  const btQuaternion turned = cell.kind == Zoo::capsule ? btQuaternion(btVector3(0, 1, 0), SIMD_HALF_PI)
                                                        : btQuaternion::getIdentity();
  scene.thing = scene.zoo.loose(scene.world, cell.kind, 2.0,
                                Vec3(-0.2, ShapeZoo::rest_height(cell.kind) + 1e-3, 0.01), turned);
  btRigidBody& object = *scene.thing.object;
  object.setFriction(1);
  object.setAngularFactor(0);
  scene.tilt(angle);
  return measure(
      scene, [&] { return double(object.getWorldTransform().getOrigin().x()); },
      [&] { return double(object.getLinearVelocity().x()); });
}

template <class Slide>
void judge(const Cell& cell, Slide slide) {
  const double angle = std::atan(kFriction);
  const Motion below = slide(cell, 0.99 * angle), above = slide(cell, 1.01 * angle);
  const double law = by_law(1.01 * angle);
  std::printf("    %-24s below: drift %8.1e m/s; above: %5.3f of the law\n", name_of(cell).c_str(),
              below.drift, above.acceleration / law);
  EXPECT_LE(std::abs(below.drift), kDrift);
  EXPECT_NEAR(above.acceleration / law, 1.0, kLaw);
}

class MatrixSlideOn : public ::testing::TestWithParam<Cell> {};
class MatrixSlideOf : public ::testing::TestWithParam<Cell> {};

TEST_P(MatrixSlideOn, BeginsAtTheAngleOfFriction) { judge(GetParam(), slide_on); }
TEST_P(MatrixSlideOf, BeginsAtTheAngleOfFriction) { judge(GetParam(), slide_of); }

bool slides(Zoo kind) { return may_move(kind) && kind != Zoo::deformable; }
std::string slide_name(const ::testing::TestParamInfo<Cell>& info) { return name_of(info.param); }

INSTANTIATE_TEST_SUITE_P(Cells, MatrixSlideOn, ::testing::ValuesIn(cells(has_flat_side)), slide_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixSlideOf, ::testing::ValuesIn(cells(slides)), slide_name);

}  // namespace
}  // namespace softpoint
