#include "metrics_figure.h"

#include <nlohmann/json.hpp>

namespace softpoint::inline SOFTPOINT_ABI::scene {

using nlohmann::ordered_json;

ordered_json figures_json(const Player& player) {
  ordered_json all = ordered_json::array();
  for (std::size_t k = 0; k < player.figure_count(); ++k) {
    const figure::FigureAnimation& animation = player.figure(k).animation();
    ordered_json events = ordered_json::array();
    for (const figure::PlaceEvent& event : animation.events()) {
      const bool landing = event.kind == figure::PlaceEvent::Kind::kLanding;
      events.push_back({{"kind", landing ? "landing" : "take-off"},
                        {"time", event.time},
                        {"link", animation.model().links()[static_cast<std::size_t>(event.link)].name}});
    }
    const figure::AnimationCounts& counts = animation.counts();
    all.push_back({{"name", player.scene().figures[k].name},
                   {"frames", animation.frame_count()},
                   {"seconds", player.figure(k).seconds()},
                   {"events", events},
                   {"dynamic_steps", counts.dynamic_steps},
                   {"forward_calls", counts.forward_calls},
                   {"boxes_overlapping", counts.boxes_overlapping},
                   {"narrow_tests", counts.narrow_tests},
                   {"feet_missed", counts.feet_missed},
                   {"guard_fired", counts.guard_fired}});
  }
  return all;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
