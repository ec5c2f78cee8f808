// Every kind of shape in every world as a slope, and as what slides: friction holds at 0.99 of the angle of
// friction and lets go at 1.01 of it.
#include <gtest/gtest.h>

#include "support/matrix_scene.h"
#include "support/matrix_slope.h"

namespace softpoint {
namespace {

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
      scene.world, [&] { return block->center_of_mass().x(); },
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
      scene.world, [&] { return double(object.getWorldTransform().getOrigin().x()); },
      [&] { return double(object.getLinearVelocity().x()); });
}

class MatrixSlideOn : public ::testing::TestWithParam<Cell> {};
class MatrixSlideOf : public ::testing::TestWithParam<Cell> {};

TEST_P(MatrixSlideOn, BeginsAtTheAngleOfFriction) {
  judge_slope(name_of(GetParam()), [](double angle) { return slide_on(GetParam(), angle); });
}
TEST_P(MatrixSlideOf, BeginsAtTheAngleOfFriction) {
  judge_slope(name_of(GetParam()), [](double angle) { return slide_of(GetParam(), angle); });
}

bool slides(Zoo kind) { return may_move(kind) && kind != Zoo::deformable; }
std::string slide_name(const ::testing::TestParamInfo<Cell>& info) { return name_of(info.param); }

INSTANTIATE_TEST_SUITE_P(Cells, MatrixSlideOn, ::testing::ValuesIn(cells(has_flat_side)), slide_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixSlideOf, ::testing::ValuesIn(cells(slides)), slide_name);

}  // namespace
}  // namespace softpoint
