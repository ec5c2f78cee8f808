// Every kind of shape in every world: drop, roll and the exchange of momentum. Slopes: matrix_slide_test.cpp.
// Penetration is measured in every frame, vertices of the skin in the shape and corners of the shape in the
// skin, by brute force (support/penetration.h, support/triangle_surface.h).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/matrix_scene.h"
#include "support/matrix_watch.h"

namespace softpoint {
namespace {

class MatrixDropOn : public ::testing::TestWithParam<Cell> {};
class MatrixDropOf : public ::testing::TestWithParam<Cell> {};
class MatrixRollOn : public ::testing::TestWithParam<Cell> {};
class MatrixRollOf : public ::testing::TestWithParam<Cell> {};
class MatrixMomentum : public ::testing::TestWithParam<Cell> {};

TEST_P(MatrixDropOn, BodyStaysOutside) {
  for (const Fall& fall : falls()) {
    MatrixScene scene(GetParam().world);
    scene.put_ground(GetParam().kind, Ground::bumpy, kSoft);
    const Mat3 turned = Eigen::AngleAxisd(fall.angle, fall.axis.normalized()).toRotationMatrix();
    const auto body = place_above(scene, Shape::part, kSoft, fall.beside, 0.02, turned);
    body->set_velocity(Vec3(0, -fall.speed, 0), Vec3(0.5, 0.2, -0.3));
    scene.system->add(*body);
    Watch watch;
    for (int i = 0; i < 45; ++i) {
      scene.world.step();
      watch.see(scene.depth(*body), i, *scene.system);
    }
    watch.judge(name_of(GetParam()), *scene.system);
  }
}

TEST_P(MatrixDropOf, ShapeStaysOutside) {
  for (const Fall& fall : falls()) {
    MatrixScene scene(GetParam().world);
    scene.put_slab(kSoft);
    std::unique_ptr<ElasticBody> block;
    if (GetParam().kind == Zoo::deformable) {
      block = place_above(scene, Shape::block, kSoft, fall.beside, 0.02,
                          Eigen::AngleAxisd(fall.angle, fall.axis.normalized()).toRotationMatrix());
      block->set_velocity(Vec3(0, -fall.speed, 0), Vec3(0.5, 0.2, -0.3));
      scene.system->add(*block);
    } else {
      scene.thing = scene.zoo.loose(scene.world, GetParam().kind, 2.0, fall.beside + Vec3(0, 0.17, 0),
                                    btQuaternion(to_bt(fall.axis.normalized()), btScalar(fall.angle)));
      scene.thing.object->setLinearVelocity(btVector3(0, btScalar(-fall.speed), 0));
      scene.thing.object->setAngularVelocity(to_bt(Vec3(0.5, 0.2, -0.3)));
    }
    Watch watch;
    for (int i = 0; i < 45; ++i) {
      scene.world.step();
      watch.see(scene.depth(block ? *block : *scene.slab), i, *scene.system);
    }
    watch.judge(name_of(GetParam()), *scene.system);
  }
}

TEST_P(MatrixRollOn, BallRollsSmoothly) {
  const bool on_slab = GetParam().kind == Zoo::deformable;
  MatrixScene scene(GetParam().world);
  scene.put_ground(GetParam().kind, Ground::rolling, 1e6);
  const double speed = on_slab ? 0.5 : 0.8, radius = 0.12;
  const Vec3 from(on_slab ? -0.28 : -0.4, 0, 0.01);
  const auto ball = place_above(scene, Shape::marble, 3e5, from, 1.01e-3, Mat3::Identity());
  ball->set_velocity(Vec3(speed, 0, 0), Vec3(0, 0, -speed / radius));
  scene.system->add(*ball);
  Watch watch;
  Track track;
  for (int i = 0; i < 60; ++i) {
    scene.world.step();
    watch.see(scene.depth(*ball), i, *scene.system);
    track.heights.push_back(ball->center_of_mass().y());
  }
  watch.judge(name_of(GetParam()), *scene.system);
  const double way = ball->center_of_mass().x() - from.x();
  track.judge(name_of(GetParam()), way);
  EXPECT_GT(way, 0.5 * speed);
}

TEST_P(MatrixRollOf, ShapeRollsSmoothly) {
  const Zoo kind = GetParam().kind;
  MatrixScene scene(GetParam().world);
  scene.put_slab(1e6);
  const double rest = ShapeZoo::rest_height(kind);
  const double speed = 0.4;
  btQuaternion turned = btQuaternion::getIdentity();
  Vec3 from(-0.25, rest + 1.01e-3, 0.01), velocity(speed, 0, 0), spin(0, 0, -speed / rest);
  if (kind == Zoo::cylinder) {  // on its side
    turned = btQuaternion(btVector3(1, 0, 0), SIMD_HALF_PI);
    from.y() = 0.09 + 1.01e-3;
    spin.z() = -speed / 0.09;
  }
  if (kind == Zoo::cone) {  // round its tip
    const double half_angle = std::atan2(0.09, 2 * rest);
    turned = btQuaternion(btVector3(1, 0, 0), btScalar(std::numbers::pi / 2 + half_angle));
    from = Vec3(0, rest * std::sin(half_angle) + 1.01e-3, -rest * std::cos(half_angle));
    spin = Vec3(0, 0, -4.0);
    velocity = Vec3(4.0 * rest * std::sin(half_angle), 0, 0);
  }
  scene.thing = scene.zoo.loose(scene.world, kind, 2.0, from, turned);
  btRigidBody& object = *scene.thing.object;
  object.setLinearVelocity(to_bt(velocity));
  object.setAngularVelocity(to_bt(spin));
  Watch watch;
  Track track;
  for (int i = 0; i < 60; ++i) {
    scene.world.step();
    watch.see(scene.depth(*scene.slab), i, *scene.system);
    track.heights.push_back(object.getWorldTransform().getOrigin().y());
  }
  watch.judge(name_of(GetParam()), *scene.system);
  const double way = (to_vec(object.getWorldTransform().getOrigin()) - from).norm();
  track.judge(name_of(GetParam()), way);
  EXPECT_GT(way, kind == Zoo::cone ? 0.03 : 0.5 * speed);
}

struct Totals {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double linear_scale = 0, angular_scale = 0;  // sum |m v|, sum |r| |m v|
  void add(const Vec3& r, const Vec3& p, const Vec3& spin = Vec3::Zero()) {
    linear += p;
    angular += r.cross(p) + spin;
    linear_scale += p.norm();
    angular_scale += r.norm() * p.norm() + spin.norm();
  }
  void add(const Deformable& body) {
    for (std::size_t v = 0; v < body.points().size(); ++v) {
      add(body.points()[v], body.masses()[v] * body.velocities()[v]);
    }
  }
};

// Without gravity each step keeps what body and shape have together. The shape is given the same inertia
// about every axis, because only then does Bullet's own integrator keep its angular momentum.
TEST_P(MatrixMomentum, IsKeptInEveryStep) {
  const Zoo kind = GetParam().kind;
  MatrixScene scene(GetParam().world);
  scene.world->setGravity(btVector3(0, 0, 0));
  ElasticBody ball(model_of(Shape::marble, kSoft), Vec3(0.1, 0.05, -0.1));
  ball.set_velocity(Vec3(0.3, 0, 0.1), Vec3(0, 2, 1));
  scene.system->add(ball);
  const Vec3 from(0.13, 0.32, -0.08), velocity(0, -2, 0), spin(3, -1, 2);
  const double mass = 5, inertia = 0.03;
  std::unique_ptr<ElasticBody> block;
  if (kind == Zoo::deformable) {
    block = std::make_unique<ElasticBody>(model_of(Shape::block, kSoft), from,
                                          Eigen::AngleAxisd(0.5, Vec3(1, 0, 0.3).normalized()).matrix());
    block->set_velocity(velocity, spin);
    scene.system->add(*block);
  } else {
    scene.thing = scene.zoo.loose(scene.world, kind, mass, from,
                                  btQuaternion(btVector3(1, 0, btScalar(0.3)).normalized(), btScalar(0.5)));
    scene.thing.object->setMassProps(btScalar(mass), to_bt(Vec3::Constant(inertia)));
    scene.thing.object->updateInertiaTensor();
    scene.thing.object->setGravity(btVector3(0, 0, 0));
    scene.thing.object->setLinearVelocity(to_bt(velocity));
    scene.thing.object->setAngularVelocity(to_bt(spin));
  }
  const auto totals = [&] {
    Totals t;
    t.add(ball);
    if (block) {
      t.add(*block);
    } else {
      const btRigidBody& o = *scene.thing.object;
      t.add(to_vec(o.getWorldTransform().getOrigin()), mass * to_vec(o.getLinearVelocity()),
            inertia * to_vec(o.getAngularVelocity()));
    }
    return t;
  };
  Totals before = totals();
  double linear = 0, angular = 0;
  int touched = 0;
  for (int i = 0; i < 60; ++i) {
    scene.world.step();
    const Totals after = totals();
    linear = std::max(linear, (after.linear - before.linear).norm() / after.linear_scale);
    angular = std::max(angular, (after.angular - before.angular).norm() / after.angular_scale);
    touched += !scene.system->contacts().empty();
    before = after;
  }
  std::printf("    %-24s linear %.1e, angular %.1e, %d steps in contact\n", name_of(GetParam()).c_str(),
              linear, angular, touched);
  EXPECT_GT(touched, 2);
  EXPECT_LE(linear, kMomentum);
  EXPECT_LE(angular, kMomentum);
}

bool any(Zoo) { return true; }
bool rolls(Zoo kind) {
  return kind == Zoo::sphere || kind == Zoo::capsule || kind == Zoo::cylinder || kind == Zoo::cone;
}
std::string cell_name(const ::testing::TestParamInfo<Cell>& info) { return name_of(info.param); }

INSTANTIATE_TEST_SUITE_P(Cells, MatrixDropOn, ::testing::ValuesIn(cells(any)), cell_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixDropOf, ::testing::ValuesIn(cells(may_move)), cell_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixRollOn, ::testing::ValuesIn(cells(any)), cell_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixRollOf, ::testing::ValuesIn(cells(rolls)), cell_name);
INSTANTIATE_TEST_SUITE_P(Cells, MatrixMomentum, ::testing::ValuesIn(cells(may_move)), cell_name);

}  // namespace
}  // namespace softpoint
