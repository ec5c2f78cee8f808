#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <memory>
#include <vector>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI {

// Told of every pair of a deformable of ours and another object that the broadphase and the app's
// filters let through, once a substep, before Bullet solves.
class PairListener {
 public:
  virtual ~PairListener() = default;
  virtual bool owns(const btCollisionObject* object) const = 0;
  virtual void pair_found(const btCollisionObject* deformable, const btCollisionObject* other, double dt) = 0;
  // Their bounds have parted, or one of them leaves the world (it may be deleted right after).
  virtual void pair_gone(const btCollisionObject* deformable, const btCollisionObject* other) = 0;
};

// Our own collision functions for soft shapes, in every collision configuration: stock ones would extrude
// the triangles of planes and meshes by 6 cm, or overflow the pool of a plain configuration. Pairs that
// involve no body of ours go to the functions registered before.
class PairHook {
 public:
  PairHook(btCollisionDispatcher& dispatcher, PairListener& listener);
  ~PairHook();
  PairHook(const PairHook&) = delete;
  PairHook& operator=(const PairHook&) = delete;

 private:
  class CreateFunc;
  void install(int type_a, int type_b);

  btCollisionDispatcher& dispatcher_;
  PairListener& listener_;
  std::vector<std::unique_ptr<CreateFunc>> functions_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI
