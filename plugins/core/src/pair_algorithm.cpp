#include "pair_algorithm.h"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionCreateFunc.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

#include <new>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

// Makes no contact manifold; it only says that the two are near.
class PairAlgorithm final : public btCollisionAlgorithm {
 public:
  PairAlgorithm(const btCollisionAlgorithmConstructionInfo& info, PairListener& listener,
                const btCollisionObject* deformable, const btCollisionObject* other)
      : btCollisionAlgorithm(info), listener_(listener), deformable_(deformable), other_(other) {}
  ~PairAlgorithm() override { listener_.pair_gone(deformable_, other_); }
  PairAlgorithm(const PairAlgorithm&) = delete;
  PairAlgorithm& operator=(const PairAlgorithm&) = delete;

  void processCollision(const btCollisionObjectWrapper*, const btCollisionObjectWrapper*,
                        const btDispatcherInfo& info, btManifoldResult*) override {
    if (info.m_dispatchFunc == btDispatcherInfo::DISPATCH_DISCRETE) {
      listener_.pair_found(deformable_, other_, info.m_timeStep);
    }
  }
  btScalar calculateTimeOfImpact(btCollisionObject*, btCollisionObject*, const btDispatcherInfo&,
                                 btManifoldResult*) override {
    return 1;
  }
  void getAllContactManifolds(btManifoldArray&) override {}

 private:
  PairListener& listener_;
  const btCollisionObject* deformable_;
  const btCollisionObject* other_;
};

// The application may have registered functions of its own; the dispatcher's table has no public reader.
struct Registered : btCollisionDispatcher {
  static btCollisionAlgorithmCreateFunc* of(btCollisionDispatcher& dispatcher, int type_a, int type_b) {
    return (dispatcher.*(&Registered::m_doubleDispatchContactPoints))[type_a][type_b];
  }
};

}  // namespace

class PairHook::CreateFunc final : public btCollisionAlgorithmCreateFunc {
 public:
  CreateFunc(PairListener& listener, btCollisionAlgorithmCreateFunc* before, int first_type, int second_type)
      : original(before), type_a(first_type), type_b(second_type), listener_(listener) {}

  btCollisionAlgorithm* CreateCollisionAlgorithm(btCollisionAlgorithmConstructionInfo& info,
                                                 const btCollisionObjectWrapper* a,
                                                 const btCollisionObjectWrapper* b) override {
    const btCollisionObject* first = a->getCollisionObject();
    const btCollisionObject* second = b->getCollisionObject();
    if (!listener_.owns(first)) {
      if (!listener_.owns(second)) {
        return original->CreateCollisionAlgorithm(info, a, b);
      }
      std::swap(first, second);
    }
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(PairAlgorithm));
    return new (memory) PairAlgorithm(info, listener_, first, second);
  }

  btCollisionAlgorithmCreateFunc* original;
  int type_a, type_b;

 private:
  PairListener& listener_;
};

PairHook::PairHook(btCollisionDispatcher& dispatcher, PairListener& listener)
    : dispatcher_(dispatcher), listener_(listener) {
  for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {
    install(SOFTBODY_SHAPE_PROXYTYPE, type);
    if (type != SOFTBODY_SHAPE_PROXYTYPE) {
      install(type, SOFTBODY_SHAPE_PROXYTYPE);
    }
  }
}

void PairHook::install(int type_a, int type_b) {
  btCollisionAlgorithmCreateFunc* original = Registered::of(dispatcher_, type_a, type_b);
  functions_.push_back(std::make_unique<CreateFunc>(listener_, original, type_a, type_b));
  dispatcher_.registerCollisionCreateFunc(type_a, type_b, functions_.back().get());
}

PairHook::~PairHook() {
  for (const auto& function : functions_) {
    dispatcher_.registerCollisionCreateFunc(function->type_a, function->type_b, function->original);
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
