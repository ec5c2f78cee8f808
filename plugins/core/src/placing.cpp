// Stage of a substep: which colliders are near, where they are and how they move.
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <algorithm>
#include <utility>

#include "deformable_system_impl.h"

namespace softpoint::inline SOFTPOINT_ABI {

void DeformableSystem::Impl::add_shape(int body, int rigid, const btCollisionShape& shape, const Pose& local,
                                       int& child) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      add_shape(body, rigid, *compound.getChildShape(i), local * from_bullet(compound.getChildTransform(i)),
                child);
    }
    return;
  }
  const ColliderShape& collider = shapes_.get(shape);
  if (collider.kind == ColliderShape::Kind::unsupported) {
    ++profile.counts.pairs_skipped;
    return;
  }
  placed_.push_back({body, {static_cast<int>(placed_.size()), rigid, child++, &collider, local}});
}

// The broadphase knew the bounds of the last step. Where handles, impulses or a longer step take a body
// farther, ask it again, with the same filters.
void DeformableSystem::Impl::add_pairs_ahead() {
  struct Query final : btBroadphaseAabbCallback {
    bool process(const btBroadphaseProxy* proxy) override {
      const auto* object = static_cast<const btCollisionObject*>(proxy->m_clientObject);
      btBroadphaseProxy* own = impl->bodies[static_cast<std::size_t>(body)]->getBroadphaseHandle();
      auto* other = const_cast<btBroadphaseProxy*>(proxy);
      btOverlapFilterCallback* filter = impl->world.getPairCache()->getOverlapFilterCallback();
      const bool wanted = filter != nullptr
                              ? filter->needBroadphaseCollision(own, other)
                              : (own->m_collisionFilterGroup & other->m_collisionFilterMask) != 0 &&
                                    (other->m_collisionFilterGroup & own->m_collisionFilterMask) != 0;
      if (own == proxy || !wanted ||
          !impl->world.getDispatcher()->needsCollision(impl->bodies[static_cast<std::size_t>(body)],
                                                       object)) {
        return true;
      }
      for (const Pair& pair : impl->pairs_) {
        if (pair.body == body && pair.other == object) {
          return true;
        }
      }
      impl->pairs_.push_back({body, object, true});
      return true;
    }
    Impl* impl = nullptr;
    int body = 0;
  } query;
  query.impl = this;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Deformable& body = *bodies[b];
    Vec3 low = body.end_positions_.front(), high = low;
    const auto include = [&](const Vec3& p) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    };
    for (const Vec3& p : body.end_positions_) {
      include(p);
    }
    for (const Handle& held : handles) {
      if (held.body == static_cast<int>(b)) {
        include(held.target);
      }
    }
    const Vec3 known_low = from_bullet(body.m_bounds[0]), known_high = from_bullet(body.m_bounds[1]);
    if (((low - known_low).array() >= 0.0).all() && ((known_high - high).array() >= 0.0).all()) {
      continue;
    }
    low = low.cwiseMin(known_low);
    high = high.cwiseMax(known_high);
    if (!low.allFinite() || !high.allFinite()) {
      continue;  // the guard will see to it
    }
    query.body = static_cast<int>(b);
    world.getBroadphase()->aabbTest(to_bullet(low), to_bullet(high), query);
    ++profile.counts.swept_queries;
  }
}

void DeformableSystem::Impl::place_colliders(double dt) {
  shapes_.begin_substep();
  placed_.clear();
  profile.counts.pairs = static_cast<int>(pairs_.size());
  add_pairs_ahead();
  for (const Pair& pair : pairs_) {
    if (!pair.other->hasContactResponse() ||
        !bodies[static_cast<std::size_t>(pair.body)]->hasContactResponse()) {
      continue;
    }
    const int rigid = rigid_.find_or_add(pair.other, dt);
    int child = 0;
    add_shape(pair.body, rigid, *pair.other->getCollisionShape(), Pose(), child);
  }
  // Contacts whose pair is gone keep their collider for one more solve, which gives their push back.
  for (Contact& contact : contacts_.all()) {
    contact.rigid = rigid_.find_or_add(contact.object, dt);
    contact.shape_index = -1;
    for (const PlacedShape& placed : placed_) {
      if (placed.body == contact.body && placed.instance.rigid == contact.rigid &&
          placed.instance.child == contact.child) {
        contact.shape_index = placed.instance.index;
      }
    }
  }
  support_.clear();
  if (settings.rigid_support && !placed_.empty()) {
    support_.collect(*world.getDispatcher(), rigid_, dt);
  }
  profile.counts.support_points = support_.size();
  for (const Contact& contact : contacts_.all()) {
    rigid_.push_free(contact.rigid, contact.impulse, contact.arm);  // what open_substep had taken
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    profile.counts.without_pairs +=
        std::none_of(placed_.begin(), placed_.end(), [&](const PlacedShape& p) { return p.body == int(b); });
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
