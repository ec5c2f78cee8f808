// Bullet's smallest program, a box that falls on a ground, and the few lines that add an elastic body.
#include <btBulletDynamicsCommon.h>

#include <cstdio>

// Softpoint, 1 of 3: what an elastic body needs.
#include "softpoint/core/deformable_system.h"
#include "softpoint/core/error.h"
#include "softpoint/core/shapes.h"
#include "softpoint/elastic/elastic_body.h"

namespace {

void simulate() {
  // A Bullet world as in any program.
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &solver, &configuration);
  world.setGravity(btVector3(0, -10, 0));

  btStaticPlaneShape ground_shape(btVector3(0, 1, 0), 0);
  btRigidBody ground(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &ground_shape));
  world.addRigidBody(&ground);

  btBoxShape box_shape(btVector3(btScalar(0.15), btScalar(0.15), btScalar(0.15)));
  btVector3 inertia;
  box_shape.calculateLocalInertia(5, inertia);
  btRigidBody box(btRigidBody::btRigidBodyConstructionInfo(5, nullptr, &box_shape, inertia));
  box.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(1.5), 0)));
  world.addRigidBody(&box);

  // Softpoint, 2 of 3: an elastic cube of 40 cm below the box.
  const softpoint::TriangleMesh cube = softpoint::box_grid(3, 3, 3, softpoint::Vec3(0.4, 0.4, 0.4));
  const softpoint::elastic::Material rubber{.young = 5e4, .poisson = 0.3, .density = 300};  // Pa, 1, kg/m3
  softpoint::elastic::ElasticBody body(softpoint::elastic::make_elastic_model(cube, rubber),
                                       softpoint::Vec3(0, 0.5, 0));
  softpoint::DeformableSystem soft(world);
  soft.add(body);

  for (int step = 0; step < 180; ++step) {
    world.stepSimulation(btScalar(1.0 / 60.0), 10);
    if (step % 20 == 19) {
      const double box_height = box.getWorldTransform().getOrigin().y();
      // Softpoint, 3 of 3: its points are there to read.
      std::printf("%.2f s: box at %.3f m, elastic cube at %.3f m, touching at %zu points\n",
                  (step + 1) / 60.0, box_height, body.center_of_mass().y(), soft.contacts().size());
    }
  }
  world.removeRigidBody(&box);
  world.removeRigidBody(&ground);
}

}  // namespace

int main() {
  try {
    simulate();
  } catch (const softpoint::Error& error) {
    std::fprintf(stderr, "hello_elastic: %s\n", error.what());
    return 1;
  }
}
