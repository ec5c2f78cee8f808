#pragma once

#include <optional>
#include <vector>

#include "scene.h"
#include "softpoint/core/deformable_system.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// The named handles of a scene. One holds a point, or several that keep their places to each other, and
// may be led along a path.
class HandleSet {
 public:
  struct Held {
    Deformable* body = nullptr;
    int point = 0;
    HandleId id = 0;
    Vec3 offset = Vec3::Zero();             // m, of the point's target from the handle
    const btCollisionObject* to = nullptr;  // carries the point; null: the handle does
    Vec3 local = Vec3::Zero();              // m, of the point's target in its frame
  };

  HandleSet(DeformableSystem& system, std::size_t count) : system_(system), handles_(count) {}

  // `near` in the world; used where the event names no vertices. `to`: the body of an attach event.
  void grab(const GrabEvent& event, Deformable& body, const Vec3& near, const btCollisionObject* to);
  // An end of a part; `body` and its `articulation`.
  void hold(const HoldEvent& event, Deformable& body, Articulation& articulation);
  void move(const MoveEvent& event, double now);
  void release(int handle);
  // The body has left the system, and took what held it along.
  void forget(const Deformable& body);
  // The body is about to leave the world: what is attached to it is let go.
  void forget_carrier(const btCollisionObject& to);
  // Leads all handles to where they are at that time.
  void lead(double now);

  std::size_t count() const { return handles_.size(); }
  const std::vector<Held>& held(std::size_t handle) const { return handles_[handle].held; }
  // Where a handle holds the end of a part (m), if it does.
  std::optional<Vec3> held_end(std::size_t handle) const;
  // m; where the handle is led to now.
  const Vec3& position(std::size_t handle) const { return handles_[handle].position; }
  // m; where a held point is to be now.
  Vec3 target(std::size_t handle, const Held& held) const;
  // Sum of its forces on the body in the last substep (N).
  Vec3 force(std::size_t handle) const;

 private:
  struct Handle {
    std::vector<Held> held;
    Vec3 position = Vec3::Zero();
    Path path;  // times of the scene
    // The end of a part.
    Deformable* body = nullptr;
    Articulation* articulation = nullptr;  // null: none is held
    int end = 0;
    Vec3 turn = Vec3::Zero();  // axis times angle (rad), from the rest pose
    Path turns;
  };

  DeformableSystem& system_;
  std::vector<Handle> handles_;
};

// The vertex of `body` nearest to `position`.
int nearest_vertex(const Deformable& body, const Vec3& position);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
