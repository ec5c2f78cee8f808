// Stage of a substep: bodies that solve their own contact (Deformable::solves_contact). They are shown the
// colliders near them and push those as they go; the sum of it is carried into the next substep, so that
// Bullet's solver knows the load.
#include <algorithm>

#include "deformable_system_impl.h"
#include "snapshot_bytes.h"
#include "softpoint/core/state_archive.h"

namespace softpoint::inline SOFTPOINT_ABI {

void DeformableSystem::Impl::carry_own_loads(double dt) {
  std::erase_if(own_loads_, [&](OwnLoad& load) {
    const bool gone = !in_world(load.object, load.object_index);
    if (gone) {
      bodies[static_cast<std::size_t>(load.body)]->activate(true);
    }
    return gone;
  });
  for (OwnLoad& load : own_loads_) {
    carry_own_load(load, dt);
  }
}

void DeformableSystem::Impl::carry_own_load(OwnLoad& load, double dt) {
  if (bodies[static_cast<std::size_t>(load.body)]->asleep()) {
    return;
  }
  const double scale = load.dt > 0.0 ? dt / load.dt : 0.0;
  load.wrench.impulse *= scale;
  load.wrench.moment *= scale;
  load.dt = dt;
  rigid_.push_wrench(rigid_.find_or_add(load.object, dt), load.wrench.impulse, load.wrench.moment);
}

void DeformableSystem::Impl::advance_own(double dt) {
  StageTimer timer(profile.seconds.solve);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Deformable& body = *bodies[b];
    if (body.asleep() || !body.solves_contact()) {
      continue;
    }
    const int index = static_cast<int>(b);
    see_colliders(index, dt);
    hold_points(index, dt);
    body.advance_by(dt, gravity_on(body), near_, held_);
    for (const HeldPoint& point : held_) {
      for (Handle& held : handles) {
        if (held.id == point.handle) {
          held.impulse = point.impulse;
        }
      }
    }
    keep_own_load(index, dt);
    near_.impl().settle(last_velocities_);
  }
}

void DeformableSystem::Impl::see_colliders(int body, double dt) {
  NearColliders::Impl& near = near_.impl();
  near.clear(rigid_, support_, dt);
  for (const PlacedShape& placed : own_placed_) {
    if (placed.body == body) {
      const btCollisionObject* object = rigid_[placed.instance.rigid].object;
      const double friction =
          gCalculateCombinedFrictionCallback(bodies[static_cast<std::size_t>(body)], object);
      const bool mesh = placed.instance.collider->kind == ColliderShape::Kind::mesh;
      near.add_part(near.body(placed.instance.rigid, friction), placed.instance.child,
                    *placed.instance.collider, placed.instance.local,
                    mesh ? sides_of_mesh(body, object, placed.instance.child) : std::span<signed char>());
    }
  }
  // What it no longer touches takes its load back too.
  for (const OwnLoad& load : own_loads_) {
    if (load.body == body) {
      const int collider = near.body(rigid_.find_or_add(load.object, dt), 0.0);
      near.bodies[static_cast<std::size_t>(collider)].carried = load.wrench;
    }
  }
}

// On which side of a mesh the points were; what was not near in the last step is forgotten.
std::span<signed char> DeformableSystem::Impl::sides_of_mesh(int body, const btCollisionObject* object,
                                                             int child) {
  const Deformable* owner = bodies[static_cast<std::size_t>(body)];
  const long long now = profile.totals.substeps;
  const auto known = std::find_if(mesh_sides_.begin(), mesh_sides_.end(), [&](const MeshSides& sides) {
    return sides.body == owner && sides.object == object && sides.child == child;
  });
  MeshSides& sides = known != mesh_sides_.end() ? *known : mesh_sides_.emplace_back();
  if (known == mesh_sides_.end() || sides.substep < now - 1) {
    sides = {owner, object, child, now, std::vector<signed char>(owner->positions_.size(), 0)};
  }
  sides.substep = now;
  return sides.of_points;
}

void DeformableSystem::Impl::hold_points(int body, double dt) {
  held_.clear();
  for (const Handle& held : handles) {
    if (held.body == body) {
      HeldPoint point;
      point.handle = held.id;
      point.point = held.point;
      point.target = held.target;
      point.max_force = held.max_force;
      if (held.anchored()) {
        point.collider = near_.impl().body(rigid_.find_or_add(held.object, dt), 0.0);
      }
      held_.push_back(point);
    }
  }
}

void DeformableSystem::Impl::keep_own_load(int body, double dt) {
  std::erase_if(own_loads_, [&](const OwnLoad& load) { return load.body == body; });
  for (const NearColliders::Impl::Body& near : near_.impl().bodies) {
    if (near.pushed) {
      own_loads_.push_back({body, near.seen.object, near.load, dt, near.seen.object->getWorldArrayIndex()});
    }
  }
}

void DeformableSystem::Impl::archive_own_loads(StateArchive& archive, int body) {
  std::vector<OwnLoad> mine;
  for (const OwnLoad& load : own_loads_) {
    if (load.body == body) {
      mine.push_back(load);
    }
  }
  archive.list("loads", mine, kMostInt, [&](OwnLoad& load) {
    archive_object(archive, load.object);
    archive.vector("load.impulse", load.wrench.impulse);
    archive.vector("load.moment", load.wrench.moment);
    archive.number("load.dt", load.dt, 0.0, kMost);
  });
  if (archive.loading()) {
    std::erase_if(own_loads_, [&](const OwnLoad& load) { return load.body == body; });
    for (OwnLoad& load : mine) {
      load.body = body;
      own_loads_.push_back(load);
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI
