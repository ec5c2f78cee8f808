// One small picture of a world, written and read again. The file's name is the argument.
#include "app.h"
#include "softpoint/picture/png.h"
#include "softpoint/picture/world_painter.h"

int main(int argc, char** argv) {
  require(argc == 2, "one argument, the picture's name");
  namespace picture = softpoint::picture;
  World scene;
  btBoxShape shape(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  btRigidBody box(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &shape));
  box.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(0.5), 0)));
  scene.world.addRigidBody(&box);

  picture::RenderSettings settings;
  settings.width = 96;
  settings.height = 64;
  picture::Renderer renderer(settings);
  picture::WorldPainter painter(renderer);
  picture::Material red;
  red.color = {0.9F, 0.1F, 0.1F};
  painter.set_material(box, red);
  picture::Camera camera;
  camera.eye = {2, 1.5, 3};
  renderer.begin(camera);
  painter.draw(scene.world);
  const picture::Image image = renderer.finish();
  scene.world.removeRigidBody(&box);

  int reddish = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) reddish += image.pixel(x, y)[0] > 2 * image.pixel(x, y)[1];
  }
  std::printf("%d of %d pixels show the box\n", reddish, image.width * image.height);
  require(reddish > 300 && reddish < 3000, "the box fills some of the picture");

  picture::write_png(argv[1], image);
  require(picture::read_png(argv[1]) == image, "the file holds the picture");

  settings.width = 1;
  require_refusal([&] { picture::Renderer refused(settings); }, "width");
}
