// Without gravity an elastic body and free cubes exchange momentum and lose none. Cubes, because Bullet
// keeps their angular momentum exactly: its integrator is exact where the inertia is isotropic.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

struct Totals {
  Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  double linear_scale = 0, angular_scale = 0;  // sum |m v|, sum |r| |m v|
};

Totals totals_of(const Deformable& body, const std::vector<btRigidBody*>& cubes) {
  Totals t;
  for (std::size_t v = 0; v < body.points().size(); ++v) {
    const Vec3 p = body.masses()[v] * body.velocities()[v];
    t.linear += p;
    t.angular += body.points()[v].cross(p);
    t.linear_scale += p.norm();
    t.angular_scale += body.points()[v].norm() * p.norm();
  }
  for (const btRigidBody* cube : cubes) {
    const double mass = 1.0 / cube->getInvMass(), inertia = 1.0 / cube->getInvInertiaDiagLocal().x();
    const Vec3 p = mass * to_vec(cube->getLinearVelocity()),
               r = to_vec(cube->getWorldTransform().getOrigin());
    const Vec3 spin = inertia * to_vec(cube->getAngularVelocity());
    t.linear += p;
    t.angular += r.cross(p) + spin;
    t.linear_scale += p.norm();
    t.angular_scale += r.norm() * p.norm() + spin.norm();
  }
  return t;
}

struct Case {
  const char* name;
  Shape shape;
  double young;
  double speed;  // m/s
  double mass;   // kg
  double restitution;
  double friction;
  int cubes;
  double dt;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Momentum : public ::testing::TestWithParam<Case> {};

TEST_P(Momentum, IsKeptInEveryStep) {
  const Case& c = GetParam();
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(c.shape, c.young, c.dt), Vec3(0.1, 0.05, -0.1));
  body.setRestitution(btScalar(c.restitution));
  body.setFriction(btScalar(c.friction));
  body.set_velocity(Vec3(0.3, 0, 0.1), Vec3(0, 2, 1));
  system.add(body);
  std::vector<btRigidBody*> cubes;
  const Vec3 from[] = {{0.05, 0.7, 0}, {-0.8, 0.1, 0.1}, {0.1, -0.1, 0.8}, {0.9, -0.9, 0.05}};
  for (int i = 0; i < c.cubes; ++i) {
    const btQuaternion turned(btVector3(1, btScalar(0.3 * i), btScalar(-0.4)).normalized(),
                              btScalar(0.4 + i));
    btRigidBody& cube = world.add_box(Vec3(0.1, 0.1, 0.1), c.mass, from[i], turned);
    cube.setRestitution(btScalar(c.restitution));
    cube.setFriction(btScalar(c.friction));
    cube.setLinearVelocity(to_bt(-c.speed * from[i].normalized()));
    cube.setAngularVelocity(btVector3(1, btScalar(-i), 2));
    for (btRigidBody* other : cubes) {  // Bullet's own contacts are not under test: they shift positions
      cube.setIgnoreCollisionCheck(other, true);
    }
    cubes.push_back(&cube);
  }
  double worst_linear = 0, worst_angular = 0;
  int touched = 0, when_linear = 0, when_angular = 0;
  Totals before = totals_of(body, cubes);
  const int steps = static_cast<int>(1.5 / c.dt);
  for (int i = 0; i < steps; ++i) {
    world.step(1, c.dt);
    const Totals after = totals_of(body, cubes);
    const double linear = (after.linear - before.linear).norm() / after.linear_scale;
    const double angular = (after.angular - before.angular).norm() / after.angular_scale;
    if (linear > worst_linear) worst_linear = linear, when_linear = i;
    if (angular > worst_angular) worst_angular = angular, when_angular = i;
    touched += !system.contacts().empty();
    before = after;
  }
  RecordProperty("linear", std::to_string(worst_linear));
  std::printf("    %-22s linear %.2e (step %d), angular %.2e (step %d), %d steps in contact\n", c.name,
              worst_linear, when_linear, worst_angular, when_angular, touched);
  EXPECT_GT(touched, 0);
  EXPECT_LE(worst_linear, by_precision(1e-10, 1e-5)) << "in step " << when_linear;
  EXPECT_LE(worst_angular, by_precision(1e-10, 1e-5)) << "in step " << when_angular;
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Cases, Momentum,
    ::testing::Values(Case{"SoftBallOneCube", Shape::ball, 1e5, 3, 5, 0, 0.5, 1, 1.0 / 60},
                      Case{"SoftBallFourCubes", Shape::ball, 1e5, 3, 5, 0, 0.5, 4, 1.0 / 60},
                      Case{"StiffPartFourCubes", Shape::part, 1e7, 4, 20, 0, 0.8, 4, 1.0 / 60},
                      Case{"BouncingCubes", Shape::part, 1e6, 5, 10, 1.0, 0.5, 4, 1.0 / 60},
                      Case{"FastLightCubes", Shape::ball, 1e6, 15, 1, 0, 0.3, 4, 1.0 / 60},
                      Case{"HeavyCubes", Shape::cube, 1e5, 2, 300, 0, 0.5, 3, 1.0 / 60},
                      Case{"SmoothCubes", Shape::ball, 1e9, 3, 5, 0.5, 0, 4, 1.0 / 240},
                      Case{"LongSteps", Shape::part, 1e5, 2, 5, 0, 0.5, 4, 1.0 / 30}),
    [](const auto& chosen) { return chosen.param.name; });

}  // namespace
}  // namespace softpoint
