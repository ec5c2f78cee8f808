// Handles and anchors of DeformableSystem; what solves them is in handle_solver.cpp.
#include <algorithm>

#include "deformable_system_impl.h"
#include "softpoint/core/error.h"
#include "softpoint/core/limits.h"

namespace softpoint::inline SOFTPOINT_ABI {

Handle& DeformableSystem::Impl::handle(HandleId id, const char* caller) {
  for (std::vector<Handle>* list : {&handles, &resting_handles_}) {
    for (Handle& h : *list) {
      if (h.id == id) {
        return h;
      }
    }
  }
  throw Error(
      std::string(caller) + ": handle " + std::to_string(id) +
      " is unknown; permitted is one that grab or attach returned, not released, whose object is still in "
      "the world");
}

// Whether the world holds the object, which may have been deleted: nothing of it is touched.
bool DeformableSystem::Impl::in_world(const btCollisionObject* object, int& index) const {
  const btCollisionObjectArray& objects = world.getCollisionObjectArray();
  if (index < 0 || index >= objects.size() || objects[index] != object) {
    index = objects.findLinearSearch(const_cast<btCollisionObject*>(object));
  }
  return index < objects.size();
}

// The two may collide again, unless another anchor or the application forbids it.
void DeformableSystem::Impl::let_go(const Handle& held) {
  if (held.anchored() && !held.collide) {
    bodies[static_cast<std::size_t>(held.body)]->setIgnoreCollisionCheck(held.object, false);
  }
}

void DeformableSystem::Impl::release_lost_anchors() {
  for (std::vector<Handle>* list : {&handles, &resting_handles_}) {
    std::erase_if(*list, [&](Handle& held) {
      if (!held.anchored() || in_world(held.object, held.object_index)) {
        return false;
      }
      let_go(held);
      std::erase_if(surroundings_, [&](const Surrounding& near) { return near.object == held.object; });
      bodies[static_cast<std::size_t>(held.body)]->activate(true);  // what it hung on is gone
      ++profile.totals.anchors_released;
      return true;
    });
  }
}

Handle DeformableSystem::Impl::new_handle(const char* caller, const char* target_name, const Deformable& body,
                                          int point, const Vec3& target, double max_force) {
  const std::string name = caller;
  const int index = index_of(&body);
  if (index < 0) {
    throw Error(name + ": the body is not in this system");
  }
  check_index(name + ": point", point, static_cast<long long>(body.points().size()));
  check_range(name + ": " + target_name, target, -kMaxPosition, kMaxPosition);
  if (!(max_force > 0.0)) {
    throw Error(name + ": max_force = " + to_text(max_force) + ": permitted is a number > 0, or infinity");
  }
  Handle handle;
  handle.id = next_handle++;
  handle.body = index;
  handle.point = point;
  handle.target = target;
  handle.max_force = max_force;
  handle.own = body.solves_contact();
  return handle;
}

void DeformableSystem::Impl::add_handle(Deformable& body, const Handle& handle) {
  body.wake();
  (body.asleep() ? resting_handles_ : handles).push_back(handle);
}

HandleId DeformableSystem::grab(Deformable& body, int point, const Vec3& target, double max_force) {
  const Handle handle = impl_->new_handle("grab", "target", body, point, target, max_force);
  impl_->add_handle(body, handle);
  return handle.id;
}

HandleId DeformableSystem::attach(Deformable& body, int point, const btCollisionObject& to, const Vec3& local,
                                  double max_force, bool collide) {
  int index = -1;
  if (!impl_->in_world(&to, index)) {
    throw Error("attach: the object is not in the world of this system");
  }
  if (to.getInternalType() == btCollisionObject::CO_SOFT_BODY) {
    throw Error(
        "attach: the object is a soft body; permitted are rigid bodies, links of multibodies and others");
  }
  Handle handle = impl_->new_handle("attach", "local", body, point, local, max_force);
  handle.object = &to;
  handle.object_index = index;
  handle.collide = collide;
  impl_->add_handle(body, handle);
  if (!collide) {
    body.setIgnoreCollisionCheck(&to, true);
  }
  return handle.id;
}

HandleId DeformableSystem::attach(Deformable& body, int point, const btCollisionObject& to, double max_force,
                                  bool collide) {
  if (body.system_ != this) {
    throw Error("attach: the body is not in this system");
  }
  check_index("attach: point", point, static_cast<long long>(body.points().size()));
  const Vec3 local =
      from_bullet(to.getWorldTransform()).to_local(body.points()[static_cast<std::size_t>(point)]);
  return attach(body, point, to, local, max_force, collide);
}

void DeformableSystem::move(HandleId id, const Vec3& target) {
  check_range("move: target", target, -kMaxPosition, kMaxPosition);
  Handle& handle = impl_->handle(id, "move");
  if (handle.target != target) {
    handle.target = target;
    impl_->bodies[static_cast<std::size_t>(handle.body)]->wake();
  }
}

void DeformableSystem::release(HandleId id) {
  const Handle& handle = impl_->handle(id, "release");
  impl_->let_go(handle);
  impl_->bodies[static_cast<std::size_t>(handle.body)]->wake();
  std::erase_if(impl_->handles, [&](const Handle& h) { return h.id == id; });
  std::erase_if(impl_->resting_handles_, [&](const Handle& h) { return h.id == id; });
}

bool DeformableSystem::holds(HandleId id) const {
  const auto has = [&](const std::vector<Handle>& list) {
    return std::any_of(list.begin(), list.end(), [&](const Handle& h) { return h.id == id; });
  };
  return has(impl_->handles) || has(impl_->resting_handles_);
}

Vec3 DeformableSystem::handle_force(HandleId id) const {
  const Handle& handle = impl_->handle(id, "handle_force");
  return impl_->last_step() > 0.0 ? Vec3(handle.impulse / impl_->last_step()) : Vec3(Vec3::Zero());
}

}  // namespace softpoint::inline SOFTPOINT_ABI
