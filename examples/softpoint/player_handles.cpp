#include "player_handles.h"

#include <algorithm>
#include <utility>

namespace softpoint::inline SOFTPOINT_ABI::scene {

namespace {

Placement placement_of(const btCollisionObject& object) {
  Placement placement;
  const btTransform& at = object.getWorldTransform();
  for (int r = 0; r < 3; ++r) {
    placement.position[r] = at.getOrigin()[r];
    for (int c = 0; c < 3; ++c) {
      placement.rotation(r, c) = at.getBasis()[r][c];
    }
  }
  return placement;
}

}  // namespace

int nearest_vertex(const Deformable& body, const Vec3& position) {
  const auto points = body.points();
  const auto nearest = std::min_element(points.begin(), points.end(), [&](const Vec3& a, const Vec3& b) {
    return (a - position).squaredNorm() < (b - position).squaredNorm();
  });
  return static_cast<int>(nearest - points.begin());
}

void HandleSet::grab(const GrabEvent& event, Deformable& body, const Vec3& near,
                     const btCollisionObject* to) {
  Handle& handle = handles_[static_cast<std::size_t>(event.handle)];
  const auto points = body.points();
  std::vector<int> vertices = event.vertices;
  if (vertices.empty()) {
    const int nearest = nearest_vertex(body, near);
    for (int v = 0; v < static_cast<int>(points.size()); ++v) {
      if (v == nearest || (points[static_cast<std::size_t>(v)] - near).norm() < event.radius) {
        vertices.push_back(v);
      }
    }
  }
  handle.position = Vec3::Zero();
  for (const int v : vertices) {
    handle.position += points[static_cast<std::size_t>(v)] / static_cast<double>(vertices.size());
  }
  handle.path = {};
  handle.held.clear();
  for (const int v : vertices) {
    const Vec3& point = points[static_cast<std::size_t>(v)];
    Held held{&body, v, 0, point - handle.position};
    if (to != nullptr) {
      held.to = to;
      held.local = placement_of(*to).to_local(point);
      held.id = system_.attach(body, v, *to, held.local, event.max_force, event.collide);
    } else {
      held.id = system_.grab(body, v, point, event.max_force);
    }
    handle.held.push_back(held);
  }
}

void HandleSet::hold(const HoldEvent& event, Deformable& body, Articulation& articulation) {
  Handle& handle = handles_[static_cast<std::size_t>(event.handle)];
  handle = {};
  handle.body = &body;
  handle.articulation = &articulation;
  handle.end = event.end;
  articulation.hold(event.end, event.surface);
  handle.position = articulation.position(event.end);
  handle.turn = articulation.turn(event.end);
}

void HandleSet::move(const MoveEvent& event, double now) {
  Handle& handle = handles_[static_cast<std::size_t>(event.handle)];
  Vec3 origin = Vec3::Zero();
  if (event.origin == Origin::kHandle) {
    origin = handle.position;
  } else if (event.origin == Origin::kBody) {
    origin = (handle.articulation != nullptr ? handle.body : handle.held.front().body)->center_of_mass();
  }
  std::vector<Keyframe> keyframes = {{now, handle.position}};
  for (const Keyframe& key : event.keyframes) {
    keyframes.push_back({now + key.time, origin + key.value});
  }
  handle.path = Path(std::move(keyframes), event.timing);
  handle.turns = {};
  if (!event.turns.empty()) {
    std::vector<Keyframe> turns = {{now, handle.turn}};
    for (const Keyframe& key : event.turns) {
      turns.push_back({now + key.time, key.value});
    }
    handle.turns = Path(std::move(turns), event.timing);
  }
}

void HandleSet::release(int index) {
  Handle& handle = handles_[static_cast<std::size_t>(index)];
  for (const Held& held : handle.held) {
    system_.release(held.id);
  }
  handle.held.clear();
  if (handle.articulation != nullptr) {
    handle.articulation->release(handle.end);
    handle.articulation = nullptr;
  }
}

void HandleSet::forget(const Deformable& body) {
  for (Handle& handle : handles_) {
    if (handle.articulation != nullptr && handle.body == &body) {
      handle.articulation->release(handle.end);
      handle.articulation = nullptr;
    }
    std::erase_if(handle.held, [&](const Held& held) { return held.body == &body; });
  }
}

void HandleSet::forget_carrier(const btCollisionObject& to) {
  for (Handle& handle : handles_) {
    std::erase_if(handle.held, [&](const Held& held) {
      if (held.to == &to) {
        system_.release(held.id);
      }
      return held.to == &to;
    });
  }
}

Vec3 HandleSet::target(std::size_t handle, const Held& held) const {
  return held.to != nullptr ? placement_of(*held.to).to_world(held.local)
                            : Vec3(handles_[handle].position + held.offset);
}

void HandleSet::lead(double now) {
  for (Handle& handle : handles_) {
    if ((handle.held.empty() && handle.articulation == nullptr) || handle.path.empty()) {
      continue;
    }
    handle.position = handle.path.at(now);
    if (handle.articulation != nullptr) {
      std::optional<Vec3> turn;
      if (!handle.turns.empty()) {
        turn = handle.turn = handle.turns.at(now);
      }
      handle.articulation->move(handle.end, handle.position, turn);
    }
    for (const Held& held : handle.held) {
      system_.move(held.id, handle.position + held.offset);
    }
  }
}

Vec3 HandleSet::force(std::size_t handle) const {
  Vec3 sum = Vec3::Zero();
  for (const Held& held : handles_[handle].held) {
    sum += system_.handle_force(held.id);
  }
  const Handle& of = handles_[handle];
  return of.articulation != nullptr ? of.articulation->force(of.end) : sum;
}

std::optional<Vec3> HandleSet::held_end(std::size_t handle) const {
  const Handle& of = handles_[handle];
  return of.articulation != nullptr ? std::optional<Vec3>(of.articulation->position(of.end)) : std::nullopt;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
