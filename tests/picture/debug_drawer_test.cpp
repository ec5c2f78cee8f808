#include "softpoint/picture/debug_drawer.h"

#include <btBulletDynamicsCommon.h>

#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(DebugDrawer, CollectsAndDrawsEveryKind) {
  DebugDrawer drawer;
  const btVector3 red(1, 0, 0);
  drawer.drawLine({-1, 0, 0}, {1, 0, 0}, red);
  drawer.drawTriangle({-1, -1, 0}, {0, -1, 0}, {0, -btScalar(0.5), 0}, red, btScalar(0.5));
  drawer.drawContactPoint({0, 1, 0}, {0, 1, 0}, 0, 1, red);
  drawer.draw3dText({1, 1, 0}, "hello");
  drawer.drawTransform(btTransform::getIdentity(), 1);
  EXPECT_EQ(drawer.line_count(), 1 + 3);
  EXPECT_EQ(drawer.triangle_count(), 1);
  EXPECT_EQ(drawer.contact_count(), 1);
  EXPECT_EQ(drawer.text_count(), 1);

  Renderer renderer(plain_settings());
  const auto render = [&] {
    renderer.begin(front_camera(6));
    drawer.draw(renderer);
    return renderer.finish();
  };
  const int all = count_drawn(render());
  EXPECT_GT(all, 300);
  EXPECT_EQ(count_drawn(render()), all) << "drawing keeps what was collected";
  drawer.clear();
  EXPECT_EQ(count_drawn(render()), 0);
}

TEST(DebugDrawer, ServesAWorld) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  btBoxShape floor_shape({5, 1, 5}), box_shape({btScalar(0.5), btScalar(0.5), btScalar(0.5)});
  btRigidBody floor(0, nullptr, &floor_shape), box(1, nullptr, &box_shape, {1, 1, 1});
  floor.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, -1, 0}));
  box.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(0.49), 0}));
  world.addRigidBody(&floor);
  world.addRigidBody(&box);
  DebugDrawer drawer;
  drawer.setDebugMode(btIDebugDraw::DBG_DrawWireframe | btIDebugDraw::DBG_DrawContactPoints);
  world.setDebugDrawer(&drawer);
  world.stepSimulation(btScalar(1.0 / 60));
  world.debugDrawWorld();
  const int lines = drawer.line_count(), contacts = drawer.contact_count();
  EXPECT_GE(lines, 24);
  EXPECT_GE(contacts, 3);
  world.debugDrawWorld();
  EXPECT_EQ(drawer.line_count(), lines) << "Bullet empties the drawer first";
  drawer.setDebugMode(btIDebugDraw::DBG_NoDebug);
  world.debugDrawWorld();
  EXPECT_EQ(drawer.line_count(), 0);
  world.removeRigidBody(&box);
  world.removeRigidBody(&floor);
}

TEST(DebugDrawer, KeepsTheFirstHundredWarnings) {
  DebugDrawer drawer;
  for (int i = 0; i < 150; ++i) drawer.reportErrorWarning("careful");
  EXPECT_EQ(drawer.warnings().size(), 100U);
  EXPECT_EQ(drawer.warnings().front(), "careful");
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
