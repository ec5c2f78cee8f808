#include "softpoint/picture/world_painter.h"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <Eigen/Geometry>

#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "shape_triangles.h"
#include "support.h"

namespace softpoint::inline SOFTPOINT_ABI::picture {
namespace {

using std::numbers::pi;

btTransform at(double x, double y, double z) {
  return btTransform(btQuaternion::getIdentity(),
                     btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z)));
}

// A soft world and what lives in it.
struct Scene {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  std::vector<std::unique_ptr<btCollisionObject>> objects;

  ~Scene() {
    for (const auto& object : objects) world.removeCollisionObject(object.get());
  }
  btCollisionObject& add(btCollisionShape& shape, const btTransform& transform, bool moves = true) {
    auto& object = *objects.emplace_back(std::make_unique<btCollisionObject>());
    object.setCollisionShape(&shape);
    object.setWorldTransform(transform);
    object.setCollisionFlags(moves ? 0 : btCollisionObject::CF_STATIC_OBJECT);
    world.addCollisionObject(&object);
    return object;
  }
  btSoftBody& add_soft(btSoftBody* body) {
    objects.emplace_back(body);
    world.addSoftBody(body);
    return *body;
  }
};

struct Painted {
  explicit Painted(const RenderSettings& settings = plain_settings())
      : renderer(settings), painter(renderer) {}
  Image draw(const btCollisionWorld& world, const Camera& camera) {
    renderer.begin(camera);
    painter.draw(world);
    return renderer.finish();
  }
  Renderer renderer;
  WorldPainter painter;
};

const btScalar kHalf = btScalar(0.5);

// Shapes whose outline seen along -z is known, with its area.
TEST(WorldPainter, DrawsEveryShapeAtItsSize) {
  btBoxShape box({kHalf, 1, kHalf});
  btSphereShape sphere(1);
  btCapsuleShapeX capsule(kHalf, 1);
  btCylinderShapeZ cylinder({1, 1, kHalf});
  btCylinderShape ellipse({1, kHalf, kHalf});
  btConeShape cone(1, 2);
  btConeShapeX cone_x(1, 2);
  btConvexHullShape hull;
  for (const btVector3& p :
       {btVector3(-1, 0, 0), btVector3(1, 0, 0), btVector3(0, 1, 0), btVector3(0, 0, 1)}) {
    hull.addPoint(p);
  }
  hull.setMargin(0);  // scaled, it counts its margin
  const btVector3 centers[] = {{-kHalf, 0, 0}, {kHalf, 0, 0}};
  const btScalar radii[] = {kHalf, kHalf};
  btMultiSphereShape multi(centers, radii, 2);
  btCompoundShape inner, compound;
  inner.addChildShape(at(0.5, 0, 0), &box);
  compound.addChildShape(at(-1, 0, 0), &box);
  compound.addChildShape(at(0.5, 0, 0), &inner);
  btTriangleMesh triangles;
  triangles.addTriangle({-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
  triangles.addTriangle({-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
  btBvhTriangleMeshShape mesh(&triangles, true);
  btScaledBvhTriangleMeshShape scaled(&mesh, {kHalf, 1, 1});
  btUniformScalingShape half_hull(&hull, kHalf);
  const std::vector<float> heights(5 * 5, 0.0F);
  btHeightfieldTerrainShape field(5, 5, heights.data(), btScalar(-1), btScalar(1), 2, false);
  field.setLocalScaling({kHalf, kHalf, 1});
  const struct {
    const char* name;
    btCollisionShape* shape;
    double area;
  } cases[] = {{"box", &box, 2},
               {"sphere", &sphere, pi},
               {"capsule", &capsule, 1 + pi / 4},
               {"cylinder", &cylinder, pi},
               {"flat cylinder", &ellipse, 2},
               {"cone", &cone, 2},
               {"cone along x", &cone_x, 2},
               {"hull", &hull, 1},
               {"multi-sphere", &multi, 1 + pi / 4},
               {"compound", &compound, 4},
               {"triangle mesh", &mesh, 4},
               {"scaled triangle mesh", &scaled, 2},
               {"uniform scaling", &half_hull, 0.25},
               {"height field", &field, 4}};
  const RenderSettings settings = plain_settings(240, 240);
  const Camera camera = front_camera(200, 1);  // from so far that sizes hardly depend on depth
  const double pixels_per_metre = 120 / (200 * std::tan(0.5 * pi / 180));
  for (const auto& c : cases) {
    Scene scene;
    Painted painted(settings);
    scene.add(*c.shape, at(0, 0, 0));
    const Image image = painted.draw(scene.world, camera);
    // Half of the rim's pixels lie outside of the shape.
    const int any = count_drawn(image);
    const double rim = 0.5 * 4 * std::sqrt(static_cast<double>(any));
    const double expected = c.area * pixels_per_metre * pixels_per_metre;
    EXPECT_NEAR(any - rim, expected, 0.06 * expected) << c.name;
  }
}

TEST(WorldPainter, BackSidesOfOpenMeshesShow) {
  btTriangleMesh triangles;
  triangles.addTriangle({-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
  triangles.addTriangle({0, 1, 1}, {1, -1, 1}, {-1, -1, 1});
  btBvhTriangleMeshShape mesh(&triangles, true);
  Scene scene;
  Painted painted;
  scene.add(mesh, at(0, 0, 0), false);
  Camera behind = front_camera(5);
  behind.eye.z() = -5;
  EXPECT_GT(count_drawn(painted.draw(scene.world, behind)), 500);
}

TEST(WorldPainter, HullsOfConvexShapesAreClosedOutward) {
  const btVector3 centers[] = {{-kHalf, 0, 0}, {kHalf, 0, 0}};
  const btScalar radii[] = {kHalf, btScalar(0.3)};
  btMultiSphereShape multi(centers, radii, 2);
  btConvexHullShape cube;
  for (int i = 0; i < 8; ++i) {
    cube.addPoint(btVector3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1));
  }
  cube.setLocalScaling({1, 2, 1});
  const auto volume = [](const TriangleMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const auto p = [&](int i) { return mesh.vertices[static_cast<std::size_t>(i)]; };
      sum += p(a).dot(p(b).cross(p(c))) / 6;
    }
    return sum;
  };
  EXPECT_NEAR(volume(convex_triangles(cube)), 16, 1e-4);
  EXPECT_EQ(convex_triangles(cube).triangle_count(), 12);
  // Two caps and the frustum between the tangent circles: r1 + r2 = 0.8, r1 - r2 = 0.2, distance 1.
  const double s = 0.2, c2 = 1 - s * s;
  const auto cap = [](double r, double h) { return pi * h * h * (r - h / 3); };
  const double a = 0.5 * std::sqrt(c2), b = 0.3 * std::sqrt(c2), length = 1 - s * s;
  const double expected =
      cap(0.5, 0.5 * (1 + s)) + cap(0.3, 0.3 * (1 - s)) + pi * length * (a * a + a * b + b * b) / 3;
  EXPECT_NEAR(volume(convex_triangles(multi)), expected, 0.02 * expected);
}

TEST(WorldPainter, StaticPlaneIsAFloor) {
  btStaticPlaneShape plane({0, 1, 0}, 1);  // y = 1, and the object lowers it to 0
  Scene scene;
  Painted painted;
  scene.add(plane, at(0, -1, 0), false);
  Camera camera = front_camera(5);
  camera.eye.y() = 1;
  const Image painted_image = painted.draw(scene.world, camera);
  Renderer renderer(plain_settings());
  renderer.begin(camera);
  renderer.draw_ground({0, 1, 0}, 0);
  EXPECT_EQ(painted_image, renderer.finish());
  EXPECT_GT(count_drawn(painted_image), 5000);
}

TEST(WorldPainter, TessellatesEachShapeOnce) {
  btConvexHullShape hull;
  for (int i = 0; i < 8; ++i) hull.addPoint(btVector3((i & 1) ? 1 : -1, (i & 2) ? 1 : -1, (i & 4) ? 1 : -1));
  btBoxShape box({1, 1, 1}), other_box({kHalf, kHalf, kHalf});
  btCapsuleShape capsule(1, 2), twice(2, 4);
  Scene scene;
  Painted painted;
  for (int i = 0; i < 3; ++i) {
    scene.add(hull, at(i, 0, 0));
    scene.add(box, at(i, 1, 0));
    scene.add(other_box, at(i, -1, 0));
  }
  scene.add(capsule, at(0, 0, -3));
  scene.add(twice, at(0, 0, -6));
  const Camera camera = front_camera(12);
  painted.draw(scene.world, camera);
  EXPECT_EQ(painted.painter.stats().shapes_tessellated, 3) << "the hull, any box, any capsule of that ratio";
  EXPECT_EQ(painted.renderer.stats().meshes_uploaded, 3);
  painted.draw(scene.world, camera);
  EXPECT_EQ(painted.painter.stats().shapes_tessellated, 0);
  EXPECT_EQ(painted.renderer.stats().meshes_uploaded, 0);
  hull.setLocalScaling({2, 1, 1});
  painted.draw(scene.world, camera);
  EXPECT_EQ(painted.painter.stats().shapes_tessellated, 1) << "it was changed";
}

TEST(WorldPainter, ForgetsTessellationsThatAreNoLongerDrawn) {
  btConvexHullShape hull;
  for (int i = 0; i < 4; ++i) hull.addPoint(btVector3(i == 0, i == 1, i == 2));
  Scene scene;
  Painted painted(plain_settings(16, 16));
  btCollisionObject& object = scene.add(hull, at(0, 0, 0));
  painted.draw(scene.world, front_camera(5));
  EXPECT_EQ(painted.painter.stats().shapes_kept, 1);
  painted.painter.set_visible(object, false);
  for (int i = 0; i < 300; ++i) painted.draw(scene.world, front_camera(5));
  EXPECT_EQ(painted.painter.stats().shapes_kept, 0);
  painted.painter.set_visible(object, true);
  EXPECT_GT(count_drawn(painted.draw(scene.world, front_camera(5))), 0);
}

TEST(WorldPainter, DoesNothingForWhatCannotShow) {
  btConvexHullShape hull;
  for (int i = 0; i < 4; ++i) hull.addPoint(btVector3(i == 0, i == 1, i == 2));
  Scene scene;
  Painted painted;
  scene.add(hull, at(0, 0, 100));
  scene.add_soft(btSoftBodyHelpers::CreateEllipsoid(scene.world.getWorldInfo(), {0, 0, 100}, {1, 1, 1}, 64));
  const Camera camera = front_camera(5);
  EXPECT_EQ(count_drawn(painted.draw(scene.world, camera)), 0);
  EXPECT_EQ(painted.painter.stats().objects, 2);
  EXPECT_EQ(painted.painter.stats().objects_skipped, 2);
  EXPECT_EQ(painted.painter.stats().shapes_tessellated, 0);
  EXPECT_EQ(painted.painter.stats().soft_bodies_moved, 0);
}

TEST(WorldPainter, SoftBodyFollowsItsNodes) {
  Scene scene;
  Painted painted;
  btSoftBody& ball = scene.add_soft(
      btSoftBodyHelpers::CreateEllipsoid(scene.world.getWorldInfo(), {0, 0, 0}, {1, 1, 1}, 128));
  const Camera camera = front_camera(8);
  const int before = count_drawn(painted.draw(scene.world, camera));
  EXPECT_EQ(painted.painter.stats().soft_bodies_moved, 1);
  painted.draw(scene.world, camera);
  EXPECT_EQ(painted.painter.stats().soft_bodies_moved, 0);
  EXPECT_EQ(painted.painter.stats().soft_bodies_at_rest, 1);
  EXPECT_EQ(painted.renderer.stats().meshes_uploaded, 0);
  for (int i = 0; i < ball.m_nodes.size(); ++i) ball.m_nodes[i].m_x *= kHalf;
  const int after = count_drawn(painted.draw(scene.world, camera));
  EXPECT_EQ(painted.painter.stats().soft_bodies_moved, 1);
  EXPECT_EQ(painted.renderer.stats().meshes_uploaded, 1);
  EXPECT_NEAR(static_cast<double>(before) / after, 4, 0.6);
}

TEST(WorldPainter, SoftBodyWithoutFacesIsDrawnByItsLinks) {
  Scene scene;
  Painted painted;
  scene.add_soft(btSoftBodyHelpers::CreateRope(scene.world.getWorldInfo(), {-1, 0, 0}, {1, 0, 0}, 8, 0));
  const int rope = count_drawn(painted.draw(scene.world, front_camera(5)));
  EXPECT_GT(rope, 60);
  EXPECT_LT(rope, 600);
}

TEST(WorldPainter, SoftBodyOfNodesOnlyIsDrawnByThem) {
  Scene scene;
  Painted painted;
  const btVector3 places[] = {{-1, 0, 0}, {1, 0, 0}};
  const btScalar masses[] = {1, 1};
  scene.add_soft(new btSoftBody(&scene.world.getWorldInfo(), 2, places, masses));
  EXPECT_GT(count_drawn(painted.draw(scene.world, front_camera(5))), 30);
}

TEST(WorldPainter, ASoftBodyThatBlewUpIsLeftOut) {
  Scene scene;
  Painted painted;
  btSoftBody& ball = scene.add_soft(
      btSoftBodyHelpers::CreateEllipsoid(scene.world.getWorldInfo(), {0, 0, 0}, {1, 1, 1}, 64));
  painted.draw(scene.world, front_camera(8));
  ball.m_nodes[5].m_x.setValue(std::numeric_limits<btScalar>::quiet_NaN(), 0, 0);
  EXPECT_EQ(count_drawn(painted.draw(scene.world, front_camera(8))), 0);
  ball.m_nodes[5].m_x.setValue(0, 0, 0);
  EXPECT_GT(count_drawn(painted.draw(scene.world, front_camera(8))), 500);
}

TEST(WorldPainter, AShapeWithBrokenVerticesIsLeftOut) {
  std::vector<float> heights(3 * 3, 0.0F);
  btHeightfieldTerrainShape field(3, 3, heights.data(), btScalar(-1), btScalar(1), 2, false);
  heights[4] = std::numeric_limits<float>::quiet_NaN();
  Scene scene;
  Painted painted;
  scene.add(field, at(0, 0, 0));
  EXPECT_EQ(count_drawn(painted.draw(scene.world, front_camera(6))), 0);
}

TEST(WorldPainter, ColoursAreDistinctAndCanBeOverruled) {
  btSphereShape sphere(kHalf);
  Scene scene;
  Painted painted;
  btCollisionObject& left = scene.add(sphere, at(-1, 0, 0));
  btCollisionObject& right = scene.add(sphere, at(1, 0, 0));
  btCollisionObject& wall = scene.add(sphere, at(0, 1, 0), false);
  painted.draw(scene.world, front_camera(6));
  const auto color = [&](const btCollisionObject& object) {
    const Color c = painted.painter.material(object).color;
    return std::array{c.r, c.g, c.b};
  };
  EXPECT_NE(color(left), color(right));
  EXPECT_EQ(color(wall), (std::array{kStaticColor.r, kStaticColor.g, kStaticColor.b}));
  Material black;
  black.color = {0, 0, 0};
  painted.painter.set_material(left, black);
  const Image image = painted.draw(scene.world, front_camera(6));
  const Projected middle = project(front_camera(6), 160, 120, {-1, 0, 0});
  EXPECT_LT(brightness(image.pixel(static_cast<int>(middle.x), static_cast<int>(middle.y))), 200);
  painted.painter.forget(left);
  EXPECT_NE(color(left), (std::array{0.0F, 0.0F, 0.0F}));
}

TEST(WorldPainter, SensorsStayOutUntilTheyAreMadeVisible) {
  btSphereShape sphere(1);
  Scene scene;
  Painted painted;
  btCollisionObject& sensor = scene.add(sphere, at(0, 0, 0));
  sensor.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
  EXPECT_EQ(count_drawn(painted.draw(scene.world, front_camera(6))), 0);
  painted.painter.set_visible(sensor, true);
  EXPECT_GT(count_drawn(painted.draw(scene.world, front_camera(6))), 500);
}

}  // namespace
}  // namespace softpoint::inline SOFTPOINT_ABI::picture
