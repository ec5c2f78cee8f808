#include "scenes.h"

#include <btBulletCollisionCommon.h>

#include "shapes.h"
#include "softpoint/picture/world_painter.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

Material painted(int color, double wetness = 0) {
  Material material;
  material.color = palette_color(color);
  material.wetness = wetness;
  return material;
}

Camera camera_at(const Vec3& eye, const Vec3& target) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  return camera;
}

void draw_everything(Renderer& renderer) {
  const int ball = add(renderer, unit_sphere(24, 12)), box = add(renderer, unit_box());
  renderer.begin(Camera{});
  renderer.draw_ground();
  renderer.draw_mesh(box, painted(0), placed({-1, 0.5, 0}, 0.5));
  renderer.draw_mesh(ball, painted(1, 1), placed({0.6, 0.7, 0.2}, 0.7));
  Material wire = painted(2);
  wire.wireframe = true;
  renderer.draw_mesh(ball, wire, placed({-0.2, 0.3, 1.6}, 0.3));
  renderer.draw_arrow({0.6, 1.4, 0.2}, {0, 0.6, 0}, {0.8F, 0.2F, 0.1F}, 0.04);
  renderer.draw_line({-1, 1, 0}, {0.6, 1.4, 0.2}, {0.1F, 0.1F, 0.1F});
  renderer.draw_point({-1, 1, 0}, {0.9F, 0.7F, 0.1F}, 3);
  renderer.draw_text(4, 4, "t = 0.5 s");
}

// A ball and a leaning box throw soft shadows on the floor and on each other.
void draw_shadow(Renderer& renderer) {
  const int ball = add(renderer, unit_sphere(32, 16)), box = add(renderer, unit_box());
  renderer.begin(camera_at({2.5, 3, 4}, {0, 0.4, 0}));
  renderer.draw_ground();
  renderer.draw_mesh(ball, painted(0), placed({0.7, 0.8, 0.3}, 0.6));
  Pose leaning = placed({-0.6, 0.7, 0}, 0.5);
  leaning.linear(1, 0) = 0.25;
  renderer.draw_mesh(box, painted(1), leaning);
}

// Slivers and steep edges, which samples alone keep smooth.
void draw_edges(Renderer& renderer) {
  const int box = add(renderer, unit_box()), cone = add(renderer, unit_cone(7));
  renderer.begin(front_camera(6));
  for (int i = 0; i < 9; ++i) {
    Pose bar = placed({-1.6 + 0.4 * i, 0.3, -0.1 * i});
    bar.linear = Mat3::Identity() * 0.03;
    bar.linear.col(1) = Vec3(0.12 * (i - 4), 1.2, 0);
    renderer.draw_mesh(box, painted(i), bar);
  }
  renderer.draw_mesh(cone, painted(3), placed({0, -1.2, 0.5}, 0.8));
}

void draw_words(Renderer& renderer) {
  const int ball = add(renderer, unit_sphere(24, 12));
  renderer.begin(front_camera(5));
  renderer.draw_mesh(ball, painted(4), placed({-0.8, -0.4, 0}, 0.7));
  renderer.draw_text(6, 6, "t = 1.25 s\n{|} ~ 100 %");
  renderer.draw_label({-0.8, 0.3, 0}, "top");
}

// The grid to the horizon, where lines are finer than pixels.
void draw_floor(Renderer& renderer) {
  renderer.begin(camera_at({0.3, 0.5, 4}, {0, 0.3, 0}));
  renderer.draw_ground();
}

void draw_strokes(Renderer& renderer) {
  const int ball = add(renderer, unit_sphere(12, 6));
  renderer.begin(camera_at({1.5, 1.2, 4.5}, {0, 0, 0}));
  Material wire = painted(5);
  wire.wireframe = true;
  renderer.draw_mesh(ball, wire, placed({0, 0, 0}));
  for (int i = 0; i < 6; ++i) {
    const double y = -1.25 + 0.5 * i;
    renderer.draw_line({-2, y, -0.5}, {2, y + 0.3, 0.6}, palette_color(i), 0.7 + 0.6 * i, i % 2 == 0);
    renderer.draw_point({-1.6 + 0.6 * i, 1.3, 0}, palette_color(i), 1.5 + i, i % 2 == 1);
  }
  renderer.draw_triangle({1.2, -1.2, 0.5}, {2, -1.2, 0.5}, {1.6, -0.4, 0.5}, {0.2F, 0.4F, 0.9F, 0.5F});
  renderer.draw_arrow({-1.9, -1.3, 0.5}, {0.9, 0.7, 0}, {0.8F, 0.2F, 0.1F}, 0.05);
}

void draw_wet(Renderer& renderer) {
  const int ball = add(renderer, unit_sphere(40, 20));
  renderer.begin(camera_at({0, 1.6, 4.5}, {0, 0.5, 0}));
  renderer.draw_ground();
  for (int i = 0; i < 3; ++i)
    renderer.draw_mesh(ball, painted(2, 0.5 * i), placed({1.3 * i - 1.3, 0.6, 0}, 0.6));
}

// Positions are exact in both precisions of Bullet, so that the pictures are the same.
void draw_world(Renderer& renderer) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  btStaticPlaneShape floor({0, 1, 0}, 0);
  btBoxShape box({btScalar(0.5), btScalar(0.5), btScalar(0.5)});
  btCapsuleShape capsule(btScalar(0.25), btScalar(0.5));
  btCylinderShape cylinder({btScalar(0.5), btScalar(0.5), btScalar(0.5)});
  btConeShape cone(btScalar(0.5), 1);
  btCollisionShape* shapes[] = {&floor, &box, &capsule, &cylinder, &cone};
  btCollisionObject objects[5];
  for (int i = 0; i < 5; ++i) {
    btTransform place = btTransform::getIdentity();
    if (i > 0) place.setOrigin({btScalar(1.25 * i - 3.125), btScalar(0.5), btScalar(0.25 * i)});
    objects[i].setCollisionShape(shapes[i]);
    objects[i].setWorldTransform(place);
    world.addCollisionObject(&objects[i]);
  }
  WorldPainter painter(renderer);
  renderer.begin(camera_at({1, 2.5, 6}, {0, 0.5, 0}));
  painter.draw(world);
  for (btCollisionObject& object : objects) world.removeCollisionObject(&object);
}

RenderSettings scenery(int width = 160, int height = 90) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.shadow_resolution = 512;
  return settings;
}

}  // namespace

const std::vector<PictureScene>& picture_scenes() {
  static const std::vector<PictureScene> scenes = {
      {"small_scene", scenery(192, 108), &draw_everything},
      {"shadow", scenery(), &draw_shadow},
      {"edges", plain_settings(160, 90), &draw_edges},
      {"text", plain_settings(160, 90), &draw_words},
      {"ground", scenery(), &draw_floor},
      {"lines", plain_settings(160, 90), &draw_strokes},
      {"wet", scenery(), &draw_wet},
      {"world", scenery(), &draw_world},
  };
  return scenes;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::picture
