#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <btBulletCollisionCommon.h>

#include <memory>

#include "shapes.h"
#include "softpoint/picture/world_painter.h"
#include "support.h"
#include "support/counted_heap.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

TEST(Allocation, FramesThatRepeatMakeNone) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  btBoxShape box({1, 1, 1});
  btCapsuleShape capsule(1, 1);
  btConvexHullShape hull;
  for (int i = 0; i < 4; ++i) hull.addPoint(btVector3(i == 0, i == 1, i == 2));
  btCollisionObject objects[3];
  btCollisionShape* shapes[] = {&box, &capsule, &hull};
  for (int i = 0; i < 3; ++i) {
    objects[i].setCollisionShape(shapes[i]);
    objects[i].setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(btScalar(3 * i), 0, 0)));
    world.addCollisionObject(&objects[i]);
  }
  RenderSettings settings = plain_settings();
  settings.shadows = true;
  settings.sky = true;
  Renderer renderer(settings);
  WorldPainter painter(renderer);
  TriangleMesh sphere = unit_sphere(16, 8);
  const int ball = add(renderer, sphere);
  Material wired;
  wired.wireframe = true;
  Image image;
  const auto frame = [&](int i) {
    for (Vec3& p : sphere.vertices) p *= i % 2 == 0 ? 1.01 : 1 / 1.01;
    renderer.update_mesh(ball, sphere.vertices);
    renderer.begin(Camera{});
    renderer.draw_ground();
    painter.draw(world);
    renderer.draw_mesh(ball, wired, placed({0, 1, 0}));
    renderer.draw_arrow({0, 2, 0}, {0, 1, 0}, {1, 0, 0}, 0.05);
    renderer.draw_line({0, 0, 0}, {1, 1, 1}, {});
    renderer.draw_point({0, 0, 0}, {});
    renderer.draw_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {});
    renderer.draw_text(5, 5, "a line of text that is too long for a small string");
    renderer.finish(image);
  };
  for (int i = 0; i < 4; ++i) frame(i);
  const long long before = test::heap_calls;
  for (int i = 0; i < 6; ++i) frame(i);
  const long long after = test::heap_calls;
  EXPECT_EQ(after - before, 0);
  const auto probe = std::make_unique<int>(1);
  EXPECT_GE(test::heap_calls - after, *probe) << "the counter counts";
  for (btCollisionObject& object : objects) world.removeCollisionObject(&object);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
