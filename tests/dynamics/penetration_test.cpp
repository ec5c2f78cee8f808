// What is dropped, shot or pressed stays outside: no vertex deeper than 1 mm in a rigid shape and no rigid
// corner deeper than 2 mm in the skin, in any frame, measured by brute force (support/penetration.h).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "softpoint/core/deformable_system.h"
#include "support/elastic_bodies.h"
#include "support/penetration.h"
#include "support/precision.h"
#include "support/worlds.h"

namespace softpoint {
namespace {

using elastic::ElasticBody;

constexpr double kVertexDepth = 1e-3, kCornerDepth = 2e-3;  // m

enum class Onto { plane, box_flat, box_edge, box_corner, sphere, capsule, hull, cylinder, compound };
const char* const kOntoNames[] = {"Plane",   "BoxFlat", "BoxEdge",  "BoxCorner", "Sphere",
                                  "Capsule", "Hull",    "Cylinder", "Compound"};

struct Drop {
  Shape shape;
  Onto onto;
  double speed;  // m/s at the start
  double mass;   // kg of the thing below, 0 is static
};

void PrintTo(const Drop& d, std::ostream* out) {
  *out << (d.shape == Shape::ball ? "Ball" : "Part") << "Onto" << kOntoNames[static_cast<int>(d.onto)]
       << (d.mass > 0 ? "Free" : "") << static_cast<int>(d.speed);
}

btRigidBody& put_below(TestWorld& world, Onto onto, double mass) {
  const btQuaternion upright = btQuaternion::getIdentity();
  switch (onto) {
    case Onto::plane:
      return world.add_floor(0.4);
    case Onto::box_flat:
      return world.add_box(Vec3(0.4, 0.2, 0.4), mass, Vec3(0, 0.2, 0));
    case Onto::box_edge:
      return world.add_box(Vec3(0.4, 0.28, 0.28), mass, Vec3(0, 0.4, 0),
                           btQuaternion(btVector3(1, 0, 0), btScalar(std::numbers::pi / 4)));
    case Onto::box_corner: {
      const btVector3 from = btVector3(1, 1, 1).normalized();
      return world.add_box(
          Vec3(0.25, 0.25, 0.25), mass, Vec3(0, 0.434, 0),
          btQuaternion(from.cross(btVector3(0, 1, 0)).normalized(), btAcos(from.dot(btVector3(0, 1, 0)))));
    }
    case Onto::sphere:
      return world.add(new btSphereShape(btScalar(0.2)), mass, Vec3(0, 0.2, 0));
    case Onto::capsule:
      return world.add(new btCapsuleShapeX(btScalar(0.1), btScalar(0.5)), mass, Vec3(0, 0.1, 0));
    case Onto::hull: {
      auto* hull = new btConvexHullShape;
      for (const int side : {-1, 1}) {  // an octahedron, corner up
        hull->addPoint(btVector3(btScalar(0.3 * side), 0, 0));
        hull->addPoint(btVector3(0, btScalar(0.2 * side), 0));
        hull->addPoint(btVector3(0, 0, btScalar(0.3 * side)));
      }
      return world.add(hull, mass, Vec3(0, 0.25, 0));
    }
    case Onto::cylinder:
      return world.add(new btCylinderShape(btVector3(btScalar(0.25), btScalar(0.2), btScalar(0.25))), mass,
                       Vec3(0, 0.2, 0), upright);
    case Onto::compound:
      break;
  }
  // A table upside down: its four legs are one and the same shape.
  auto* table = new btCompoundShape;
  btCollisionShape& top = world.keep(new btBoxShape(btVector3(btScalar(0.3), btScalar(0.03), btScalar(0.3))));
  btCollisionShape& leg =
      world.keep(new btBoxShape(btVector3(btScalar(0.03), btScalar(0.15), btScalar(0.03))));
  table->addChildShape(btTransform(upright, btVector3(0, btScalar(0.03), 0)), &top);
  for (const double x : {-0.12, 0.12}) {
    for (const double z : {-0.12, 0.12}) {
      table->addChildShape(btTransform(upright, btVector3(btScalar(x), btScalar(0.21), btScalar(z))), &leg);
    }
  }
  return world.add(table, mass, Vec3::Zero());
}

struct Depths {
  double vertex = -1, corner = -1;  // m
  int vertex_frame = 0, corner_frame = 0;

  void see(const Deformable& body, const btCollisionObject& object, int frame) {
    if (const double d = skin_depth(body, object); d > vertex) vertex = d, vertex_frame = frame;
    if (object.getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE) return;
    if (const double d = corner_depth(body, object); d > corner) corner = d, corner_frame = frame;
  }
};

// The law holds for ordinary drops on every shape. Blows of a soft 100 kg body at more than 5 m/s or on something
// free that is lighter are known to exceed it for some frames (bounds in the README of core).
bool in_law(const Drop& c) { return c.speed < 4 && c.mass == 0; }
double vertex_limit(const Drop& c) { return in_law(c) ? kVertexDepth : 5e-3; }
double corner_limit(const Drop& c) { return in_law(c) ? kCornerDepth : 15e-3; }

class Dropped : public ::testing::TestWithParam<Drop> {};

TEST_P(Dropped, StaysOutside) {
  const Drop& c = GetParam();
  TestWorld world;
  btRigidBody& floor = world.add_floor();
  btRigidBody& below = put_below(world, c.onto, c.mass);
  DeformableSystem system(*world);
  const Mat3 turned = Eigen::AngleAxisd(0.4, Vec3(1, 0.5, -0.7).normalized()).toRotationMatrix();
  ElasticBody body(model_of(c.shape), Vec3(0.03, 1.35, -0.02), turned);
  body.set_velocity(Vec3(0, -c.speed, 0), Vec3(0.5, 0.2, -0.3));
  system.add(body);
  Depths depths, on_floor;
  for (int i = 0; i < 180; ++i) {
    world.step();
    depths.see(body, below, i);
    on_floor.see(body, floor, i);
  }
  std::printf("    vertex %6.3f mm (frame %d), corner %6.3f mm (frame %d), floor %6.3f mm\n",
              1e3 * depths.vertex, depths.vertex_frame, 1e3 * depths.corner, depths.corner_frame,
              1e3 * on_floor.vertex);
  EXPECT_LE(depths.vertex, vertex_limit(c)) << "frame " << depths.vertex_frame;
  EXPECT_LE(depths.corner, corner_limit(c)) << "frame " << depths.corner_frame;
  EXPECT_LE(on_floor.vertex, kVertexDepth) << "frame " << on_floor.vertex_frame;
  EXPECT_EQ(system.profile().totals.guard_fired, 0);
  EXPECT_EQ(system.profile().totals.late_substeps, 0);
}

std::vector<Drop> drops() {
  std::vector<Drop> cases;
  for (const Shape shape : {Shape::ball, Shape::part}) {
    for (int onto = 0; onto < 9; ++onto) {
      for (const double speed : {2.0, 6.0}) {
        cases.push_back({shape, static_cast<Onto>(onto), speed, 0});
      }
      if (onto > 0) {
        cases.push_back({shape, static_cast<Onto>(onto), 4, 20});
      }
    }
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Cases, Dropped, ::testing::ValuesIn(drops()), ::testing::PrintToStringParamName());

// A pile of boxes under a body that is then swung about by a vertex.
TEST(Dragged, StaysOutsideOfAPile) {
  for (const Shape shape : {Shape::ball, Shape::part}) {
    TestWorld world;
    btRigidBody& floor = world.add_floor();
    std::vector<btRigidBody*> boxes;
    for (int i = 0; i < 6; ++i) {
      boxes.push_back(&world.add_box(Vec3(0.12, 0.1, 0.15), 4,
                                     Vec3(0.3 * (i % 3) - 0.3, 0.11 + 0.21 * (i / 3), 0),
                                     btQuaternion(btVector3(0, 1, 0), btScalar(0.3 * i))));
    }
    DeformableSystem system(*world);
    ElasticBody body(model_of(shape), Vec3(0, 1.2, 0));
    system.add(body);
    Depths depths, on_floor;
    HandleId handle = 0;
    const int point = 30;
    for (int i = 0; i < 420; ++i) {
      if (i == 90) handle = system.grab(body, point, body.points()[point], 2000);
      if (i >= 90 && i < 330) {
        const double t = (i - 90) / 60.0;
        system.move(handle,
                    Vec3(0.8 * std::sin(3 * t), 0.5 + 0.4 * std::cos(2.3 * t), 0.5 * std::sin(1.7 * t)));
      }
      if (i == 330) system.release(handle);
      world.step();
      for (const btRigidBody* box : boxes) depths.see(body, *box, i);
      on_floor.see(body, floor, i);
    }
    std::printf("    vertex %6.3f mm (frame %d), corner %6.3f mm (frame %d), floor %6.3f mm (frame %d)\n",
                1e3 * depths.vertex, depths.vertex_frame, 1e3 * depths.corner, depths.corner_frame,
                1e3 * on_floor.vertex, on_floor.vertex_frame);
    // Swung at 2000 N through a pile of boxes of 4 kg, it exceeds the law by a few millimetres in single
    // frames.
    EXPECT_LE(depths.vertex, 10e-3) << "frame " << depths.vertex_frame;
    EXPECT_LE(depths.corner, 40e-3) << "frame " << depths.corner_frame;
    EXPECT_LE(on_floor.vertex, kVertexDepth) << "frame " << on_floor.vertex_frame;
  }
}

// A table set on its legs on a soft cube: four legs of one shape, none may sink in.
TEST(Compound, ChildrenSharingAShapeAllTouch) {
  TestWorld world;
  world.add_floor();
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::cube, 1e6), Vec3(0, 0.202, 0));
  system.add(body);
  auto* table = new btCompoundShape;
  btCollisionShape& leg =
      world.keep(new btBoxShape(btVector3(btScalar(0.03), btScalar(0.15), btScalar(0.03))));
  for (const double x : {-0.11, 0.12}) {
    for (const double z : {-0.12, 0.11}) {
      table->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(btScalar(x), 0, btScalar(z))),
                           &leg);
    }
  }
  btRigidBody& legs = world.add(table, 20, Vec3(0, 0.56, 0));
  double deepest = -1;
  for (int i = 0; i < 180; ++i) {
    world.step();
    deepest = std::max(deepest, corner_depth(body, legs));
  }
  EXPECT_LE(deepest, kCornerDepth);
  EXPECT_GT(legs.getWorldTransform().getOrigin().y(), 0.53);
}

TEST(Fast, BoxShotThroughABodyDoesNotTunnel) {
  for (const Shape shape : {Shape::ball, Shape::part}) {
    for (const double half : {0.05, 0.15}) {
      for (const double offset : {0.0, 0.08}) {
        TestWorld world;
        world->setGravity(btVector3(0, 0, 0));
        DeformableSystem system(*world);
        ElasticBody body(model_of(shape, 1e5), Vec3::Zero());
        system.add(body);
        btRigidBody& box = world.add_box(Vec3::Constant(half), 2.0, Vec3(-3.03, offset, 0.01));
        box.setLinearVelocity(btVector3(30, 0, 0));
        Depths depths;
        for (int i = 0; i < 60; ++i) {
          world.step();
          depths.see(body, box, i);
        }
        if (offset == 0.0) {  // the others may slide past
          EXPECT_LT(box.getWorldTransform().getOrigin().x(), body.center_of_mass().x())
              << "tunnelled; half " << half << ", shape " << static_cast<int>(shape);
        }
        // At 0.5 m a step a corner that grazes the body may be in it for a frame.
        EXPECT_LE(depths.vertex, 5 * kVertexDepth) << "half " << half << ", offset " << offset;
        EXPECT_LE(depths.corner, 80e-3) << "half " << half << ", offset " << offset;
      }
    }
  }
}

TEST(Fast, BodyShotAtAThinWallStopsBeforeIt) {
  for (const Shape shape : {Shape::ball, Shape::part, Shape::cube}) {
    for (const double speed : {10.0, 30.0}) {
      TestWorld world;
      world->setGravity(btVector3(0, 0, 0));
      world.add_box(Vec3(0.01, 2, 2), 0, Vec3(1.5, 0, 0));
      DeformableSystem system(*world);
      ElasticBody body(model_of(shape, 1e6), Vec3::Zero());
      body.set_velocity(Vec3(speed, 0, 0), Vec3(0, 1, 2));
      system.add(body);
      double farthest = 0;
      for (int i = 0; i < 60; ++i) {
        world.step();
        for (const Vec3& p : body.points()) farthest = std::max(farthest, p.x());
      }
      EXPECT_LT(farthest, 1.49 + kVertexDepth) << "speed " << speed << ", shape " << static_cast<int>(shape);
    }
  }
}

// Speed given between two steps counts in the next one, however near the wall is.
TEST(Fast, SuddenSpeedNextToAWallDoesNotTunnel) {
  for (const auto& [by_impulse, free_path] :
       {std::pair(false, 0.02), {false, 0.15}, {true, 0.02}, {true, 0.15}}) {
    TestWorld world;
    world->setGravity(btVector3(0, 0, 0));
    world.add_box(Vec3(0.01, 2, 2), 0, Vec3(0.21 + free_path, 0, 0));
    DeformableSystem system(*world);
    ElasticBody body(model_of(Shape::cube, 1e6), Vec3::Zero());
    system.add(body);
    world.step(5);
    if (by_impulse) {
      for (int f = 0; f < static_cast<int>(body.faces().size()); ++f) {
        body.apply_impulse(f, Vec3::Constant(1.0 / 3),
                           Vec3(20, 0, 0) * body.total_mass() / double(body.faces().size()));
      }
    } else {
      body.set_velocity(Vec3(20, 0, 0));
    }
    double farthest = 0;
    for (int i = 0; i < 60; ++i) {
      world.step();
      for (const Vec3& p : body.points()) farthest = std::max(farthest, p.x());
    }
    EXPECT_LT(farthest, 0.2 + free_path + kVertexDepth)
        << (by_impulse ? "apply_impulse" : "set_velocity") << ", free path " << free_path;
  }
}

TEST(Fast, HandleCannotDragABodyThroughAWall) {
  TestWorld world;
  world->setGravity(btVector3(0, 0, 0));
  world.add_box(Vec3(0.01, 2, 2), 0, Vec3(0.5, 0, 0));
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball, 1e5), Vec3::Zero());
  system.add(body);
  world.step(5);
  const HandleId handle = system.grab(body, 7, body.points()[7], 3000);
  double farthest = 0;
  for (int i = 0; i < 120; ++i) {
    system.move(handle, Vec3(i < 5 ? 0.1 : 3.0, 0, 0));  // jumps to the far side
    world.step();
    for (const Vec3& p : body.points()) farthest = std::max(farthest, p.x());
  }
  EXPECT_LT(farthest, 0.49 + 2 * kVertexDepth);
}

// A press squeezes a body and holds it: it stays where it is, still and outside of the plates.
TEST(Pressed, BodyHoldsStillBetweenThePlates) {
  struct Press {
    Shape shape;
    double young, squash;
  };
  for (const Press& c : {Press{Shape::cube, 1e5, 0.6},
                         {Shape::cube, 1e6, 0.8},
                         {Shape::cube, 1e6, 0.6},
                         {Shape::cube, 1e7, 0.95},
                         {Shape::cube, 1e8, 0.95},
                         {Shape::part, 1e6, 0.6},
                         {Shape::part, 1e7, 0.95},
                         {Shape::ball, 1e6, 0.6},
                         {Shape::ball, 1e7, 0.8}}) {
    TestWorld world;
    btRigidBody& floor = world.add_box(Vec3(1, 0.5, 1), 0, Vec3(0, -0.5, 0));
    DeformableSystem system(*world);
    const double height = c.shape == Shape::cube ? 0.4 : c.shape == Shape::part ? 0.5 : 0.6;
    ElasticBody body(model_of(c.shape, c.young), Vec3(0, 0.5 * height + 1e-3, 0),
                     c.shape == Shape::part
                         ? Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3::UnitX()).toRotationMatrix()
                         : Mat3(Mat3::Identity()));
    body.setActivationState(DISABLE_DEACTIVATION);
    system.add(body);
    btRigidBody& plate = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, height + 0.11, 0));
    plate.setCollisionFlags(plate.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    double deepest = -1, fastest = 0;
    for (int i = 0; i < 300; ++i) {
      btTransform placed = plate.getWorldTransform();
      placed.setOrigin(
          btVector3(0, btScalar(height + 0.11 - (1 - c.squash) * height * std::min(1.0, i / 60.0)), 0));
      plate.setWorldTransform(placed);
      plate.setInterpolationWorldTransform(placed);
      world.step();
      deepest = std::max({deepest, skin_depth(body, plate), skin_depth(body, floor)});
      for (const Vec3& v : body.velocities()) fastest = i > 240 ? std::max(fastest, v.norm()) : 0.0;
    }
    std::printf("    shape %d, E %.0e, squashed to %.2f: fastest point %.1e m/s, deepest %.2f mm\n",
                static_cast<int>(c.shape), c.young, c.squash, fastest, 1e3 * deepest);
    EXPECT_LT(fastest, 0.01) << "E " << c.young << ", squash " << c.squash;
    EXPECT_LE(deepest, kVertexDepth) << "E " << c.young << ", squash " << c.squash;
    EXPECT_LT(std::hypot(body.center_of_mass().x(), body.center_of_mass().z()), 0.05)
        << "E " << c.young << ", squash " << c.squash;
  }
}

// A platform that the application moves pushes the body along and up.
TEST(Kinematic, PlatformLiftsTheBody) {
  TestWorld world;
  btRigidBody& lift = world.add_box(Vec3(0.5, 0.1, 0.5), 0, Vec3(0, -0.1, 0));
  lift.setCollisionFlags(lift.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  DeformableSystem system(*world);
  ElasticBody body(model_of(Shape::ball), Vec3(0, 0.302, 0));
  system.add(body);
  world.step(60);
  double deepest = -1;
  for (int i = 1; i <= 120; ++i) {
    btTransform t = lift.getWorldTransform();
    t.setOrigin(btVector3(0, btScalar(-0.1 + 0.02 * i), 0));
    lift.setWorldTransform(t);
    lift.setInterpolationWorldTransform(t);
    world.step();
    deepest = std::max(deepest, skin_depth(body, lift));
  }
  EXPECT_GT(body.center_of_mass().y(), 2.5);
  EXPECT_LE(deepest, kVertexDepth);
}

}  // namespace
}  // namespace softpoint
