#include "scene_event_order.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

void check_event_order(const Scene& scene, const std::vector<std::string>& places) {
  std::vector<std::size_t> order(scene.events.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    order[k] = k;
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return scene.events[a].at < scene.events[b].at; });
  struct Held {
    int deformable;
    std::optional<int> to;  // rigid body
    int end = -1;           // of a part
    bool may_turn = false;  // the end's surface
  };
  std::map<int, Held> held;  // by handle
  std::set<std::pair<bool, int>> off;
  for (const std::size_t k : order) {
    const auto refuse = [&](const std::string& problem) { throw Error(places[k] + ": " + problem); };
    const auto name = [&](int handle) { return scene.handles[static_cast<std::size_t>(handle)]; };
    const auto need_held = [&](int handle) {
      if (!held.contains(handle)) {
        refuse(
            fmt::format("handle \"{}\" holds nothing at {} s; permitted is a handle between its grab, pin, "
                        "attach or hold "
                        "and its release",
                        name(handle), to_text(scene.events[k].at)));
      }
    };
    const auto need_present = [&](BodyRef body) {
      if (off.contains({body.deformable, body.index})) {
        refuse(fmt::format("the body is switched off at {} s", to_text(scene.events[k].at)));
      }
    };
    const auto& action = scene.events[k].action;
    if (const auto* grab = std::get_if<GrabEvent>(&action)) {
      need_present({true, grab->deformable});
      if (grab->to) {
        need_present({false, *grab->to});
      }
      if (!held.emplace(grab->handle, Held{grab->deformable, grab->to}).second) {
        refuse(fmt::format("handle \"{}\" already holds something; release it first", name(grab->handle)));
      }
    } else if (const auto* hold = std::get_if<HoldEvent>(&action)) {
      need_present({true, hold->deformable});
      for (const auto& [handle, other] : held) {
        if (other.deformable == hold->deformable && other.end == hold->end) {
          refuse(fmt::format("handle \"{}\" holds this end already; release it first", name(handle)));
        }
      }
      if (!held.emplace(hold->handle, Held{hold->deformable, {}, hold->end, hold->surface}).second) {
        refuse(fmt::format("handle \"{}\" already holds something; release it first", name(hold->handle)));
      }
    } else if (const auto* move = std::get_if<MoveEvent>(&action)) {
      need_held(move->handle);
      if (!move->turns.empty() && !held.at(move->handle).may_turn) {
        refuse(
            fmt::format("turn: handle \"{}\" holds no surface of an end; permitted after a hold by surface",
                        name(move->handle)));
      }
      if (held.at(move->handle).to) {
        refuse(fmt::format("handle \"{}\" is attached to a body; permitted is one of grab or pin",
                           name(move->handle)));
      }
    } else if (const auto* release = std::get_if<ReleaseEvent>(&action)) {
      need_held(release->handle);
      held.erase(release->handle);
    } else if (const auto* impulse = std::get_if<ImpulseEvent>(&action)) {
      need_present(impulse->body);
    } else if (const auto* toggle = std::get_if<ToggleEvent>(&action); toggle->what == SwitchKind::kBody) {
      const std::pair key{toggle->body.deformable, toggle->body.index};
      if (toggle->on.value_or(off.contains(key))) {
        off.erase(key);
      } else {
        off.insert(key);
        std::erase_if(held, [&](const auto& h) {
          const Held& tied = h.second;
          return key == std::pair{true, tied.deformable} || (tied.to && key == std::pair{false, *tied.to});
        });
      }
    }
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
