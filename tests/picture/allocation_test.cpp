#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <btBulletCollisionCommon.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "shapes.h"
#include "softpoint/picture/world_painter.h"
#include "support.h"

namespace {

std::atomic<bool> counting{false};
std::atomic<int> allocations{0};

void* counted_or_null(std::size_t size) noexcept {
  if (counting) ++allocations;
  return std::malloc(size);
}

void* counted(std::size_t size) {
  if (void* memory = counted_or_null(size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return counted_or_null(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return counted_or_null(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

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
  counting = true;
  for (int i = 0; i < 6; ++i) frame(i);
  counting = false;
  EXPECT_EQ(allocations, 0);
  allocations = 0;
  counting = true;
  const auto probe = std::make_unique<int>(1);
  counting = false;
  EXPECT_EQ(allocations, *probe) << "the counter counts";
  for (btCollisionObject& object : objects) world.removeCollisionObject(&object);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
