#pragma once

// What the small programs share: no test framework, they are what an application would be.
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "softpoint/core/error.h"

#if defined(EXPECTED_SCALAR_BYTES)
static_assert(sizeof(btScalar) == EXPECTED_SCALAR_BYTES, "Bullet's precision did not arrive");
#endif

inline void require(bool condition, const char* what) {
  if (!condition) {
    std::fprintf(stderr, "not so: %s\n", what);
    std::exit(1);
  }
}

// `call` must throw softpoint::Error with `text` in its message; so it must arrive from a shared library too.
template <class Call>
void require_refusal(Call call, const std::string& text) {
  try {
    call();
  } catch (const softpoint::Error& error) {
    require(std::string(error.what()).find(text) != std::string::npos, error.what());
    std::printf("refused: %s\n", error.what());
    return;
  } catch (...) {
    require(false, "the exception is a softpoint::Error");
  }
  require(false, "bad input is refused");
}

// Bullet's usual world over a floor y = 0.
struct World {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btStaticPlaneShape floor_shape{btVector3(0, 1, 0), 0};
  btRigidBody floor{btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &floor_shape)};

  World() {
    world.setGravity(btVector3(0, btScalar(-9.81), 0));
    world.addRigidBody(&floor);
  }
  ~World() { world.removeRigidBody(&floor); }
  void step(int count) {
    for (int i = 0; i < count; ++i) world.stepSimulation(btScalar(1.0 / 60), 1, btScalar(1.0 / 60));
  }
};
