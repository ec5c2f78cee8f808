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
  const ColliderShape* collider = nullptr;
  if (is_mesh(shape)) {
    collider = &mesh_patch(body, rigid, static_cast<const btConcaveShape&>(shape), local, child);
  } else {
    collider = &shapes_.get(shape);
  }
  if (collider->kind == ColliderShape::Kind::unsupported) {
    ++profile.counts.pairs_skipped;
    return;
  }
  std::vector<PlacedShape>& list =
      bodies[static_cast<std::size_t>(body)]->solves_contact() ? own_placed_ : placed_;
  list.push_back({body, {static_cast<int>(list.size()), rigid, child++, collider, local}});
}

// The part of a mesh that a body may meet in this step.
const ColliderShape& DeformableSystem::Impl::mesh_patch(int body, int rigid, const btConcaveShape& shape,
                                                        const Pose& local, int child) {
  const RigidState& state = rigid_[rigid];
  Bounds region;
  bool begun = false;
  const Bounds& near = step_bounds_[static_cast<std::size_t>(body)];
  for (const Pose& placed : {state.start * local, state.end * local}) {
    for (int i = 0; i < 8; ++i) {
      const Vec3 corner(i & 1 ? near.high.x() : near.low.x(), i & 2 ? near.high.y() : near.low.y(),
                        i & 4 ? near.high.z() : near.low.z());
      const Vec3 p = placed.to_local(corner);
      begun ? region.include(p) : void(region = Bounds::of(p));
      begun = true;
    }
  }
  bool fresh = false;
  const ColliderShape& patch = patches_.get(body, *state.object, child, shape, region, fresh);
  if (fresh) {
    ++profile.counts.mesh_patches;
    // Its corners and edges have other numbers now: what they carried is given back in this step.
    for (Contact& contact : contacts_.all()) {
      if (contact.body == body && contact.object == state.object && contact.child == child &&
          (contact.kind == ContactKind::corner || contact.kind == ContactKind::edge)) {
        contact.rigid_feature = -2 - std::abs(contact.rigid_feature);
      }
    }
    contacts_.reindex();
  }
  return patch;
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
      const int second = impl->index_of(object);
      if (second >= 0 && impl->bodies[static_cast<std::size_t>(second)]->asleep()) {
        return true;  // wakes in the next step, when their bounds overlap
      }
      for (const Pair& pair : impl->pairs_) {
        if ((pair.body == body && pair.other == object) ||
            (pair.other == impl->bodies[static_cast<std::size_t>(body)] &&
             impl->bodies[static_cast<std::size_t>(pair.body)] == object)) {
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
  step_bounds_.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Deformable& body = *bodies[b];
    if (body.asleep()) {
      continue;
    }
    Bounds end = Bounds::of(body.end_positions_.front());
    for (const Vec3& p : body.end_positions_) {
      end.include(p);
    }
    for (const Handle& held : handles) {
      if (held.body == static_cast<int>(b)) {
        end.include(held.anchored() ? from_bullet(held.object->getWorldTransform()).to_world(held.target)
                                    : held.target);
      }
    }
    const Bounds known{from_bullet(body.m_bounds[0]), from_bullet(body.m_bounds[1])};
    if (!end.low.allFinite() || !end.high.allFinite()) {
      end = known;  // the guard will see to it
    }
    Bounds step = end;
    for (const Vec3& p : body.positions_) {
      step.include(p);
    }
    step_bounds_[b] = step.grown(5.0 * settings.margin);
    if (known.contains(end)) {
      continue;
    }
    end.include(known);
    query.body = static_cast<int>(b);
    world.getBroadphase()->aabbTest(to_bullet(end.low), to_bullet(end.high), query);
    ++profile.counts.swept_queries;
  }
}

void DeformableSystem::Impl::place_colliders(double dt) {
  shapes_.begin_substep();
  patches_.begin_substep();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b]->asleep()) {
      patches_.keep(static_cast<int>(b));
    }
  }
  placed_.clear();
  own_placed_.clear();
  skin_pairs_.clear();
  profile.counts.pairs = static_cast<int>(pairs_.size());
  add_pairs_ahead();
  // Bullet's order depends on what was near before.
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return a.body != b.body ? a.body < b.body : a.other->getWorldArrayIndex() < b.other->getWorldArrayIndex();
  });
  for (const Pair& pair : pairs_) {
    if (!pair.other->hasContactResponse() ||
        !bodies[static_cast<std::size_t>(pair.body)]->hasContactResponse()) {
      continue;
    }
    const int rigid = rigid_.find_or_add(pair.other, dt);
    if (const int other = index_of(pair.other); other >= 0) {
      if (bodies[static_cast<std::size_t>(pair.body)]->solves_contact() ||
          bodies[static_cast<std::size_t>(other)]->solves_contact()) {
        ++profile.counts.pairs_skipped;
        continue;
      }
      skin_pairs_.push_back(
          {pair.body, other, rigid_.find_or_add(bodies[static_cast<std::size_t>(pair.body)], dt), rigid});
      continue;
    }
    int child = 0;
    add_shape(pair.body, rigid, *pair.other->getCollisionShape(), Pose(), child);
  }
  // Contacts whose pair is gone keep their collider for one more solve, which gives their push back.
  for (Contact& contact : contacts_.all()) {
    contact.rigid = rigid_.find_or_add(contact.object, dt);
    contact.shape_index = -1;
    if (contact.rigid_feature < -1) {
      continue;  // of a patch that is gone
    }
    contact.other_body = index_of(contact.object);
    for (std::size_t i = 0; i < skin_pairs_.size(); ++i) {
      if (skin_pairs_[i].joins(contact.body, contact.other_body)) {
        contact.shape_index = static_cast<int>(i);
      }
    }
    for (const PlacedShape& placed : placed_) {
      if (placed.body == contact.body && placed.instance.rigid == contact.rigid &&
          placed.instance.child == contact.child) {
        contact.shape_index = placed.instance.index;
      }
    }
  }
  bool touched = !placed_.empty() || !own_placed_.empty();
  for (Handle& held : handles) {
    if (held.anchored()) {
      held.rigid = rigid_.find_or_add(held.object, dt);
      touched = true;
    }
  }
  support_.clear();
  if (settings.rigid_support && touched) {
    support_.collect(*world.getDispatcher(), rigid_, dt);
  }
  profile.counts.support_points = support_.size();
  for (const Contact& contact : contacts_.all()) {
    rigid_.push_free(contact.rigid, contact.impulse, contact.arm);  // what open_substep had taken
  }
  for (const Handle& held : handles) {
    if (held.anchored() && !held.own) {
      rigid_.push_free(held.rigid, held.impulse, held.arm);
    }
  }
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    profile.counts.without_pairs +=
        !bodies[b]->asleep() &&
        std::none_of(placed_.begin(), placed_.end(),
                     [&](const PlacedShape& p) { return p.body == int(b); }) &&
        std::none_of(own_placed_.begin(), own_placed_.end(),
                     [&](const PlacedShape& p) { return p.body == int(b); }) &&
        std::none_of(skin_pairs_.begin(), skin_pairs_.end(),
                     [&](const SkinPair& p) { return p.first == int(b) || p.second == int(b); });
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
