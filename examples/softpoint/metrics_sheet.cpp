#include "metrics_sheet.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace softpoint::inline SOFTPOINT_ABI::scene {

using nlohmann::ordered_json;

Heights heights_of(const Deformable& body) {
  Heights heights{body.points().front().y(), body.points().front().y()};
  for (const Vec3& x : body.points()) {
    heights.lowest = std::min(heights.lowest, x.y());
    heights.highest = std::max(heights.highest, x.y());
  }
  return heights;
}

void SheetRecorder::Range::take(double value) {
  least = std::min(least, value);
  largest = std::max(largest, value);
  now = value;
}

ordered_json SheetRecorder::Range::json() const {
  return {{"least", least}, {"largest", largest}, {"end", now}};
}

SheetRecorder::SheetRecorder(const Player& player) : player_(player) {
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    if (player.sheet(k) == nullptr) continue;
    const Heights heights = heights_of(player.deformable(k));
    Body body;
    body.index = k;
    body.highest.start(heights.highest);
    body.lowest.start(heights.lowest);
    bodies_.push_back(body);
  }
}

void SheetRecorder::record() {
  for (Body& body : bodies_) {
    const SheetState state = player_.sheet(body.index)->measure();
    const Heights heights = heights_of(player_.deformable(body.index));
    const bool first = body.substeps == 0;  // air is found in the first step
    const auto take = [first](Range& range, double value) { first ? range.start(value) : range.take(value); };
    take(body.bubbles, state.bubbles);
    take(body.volume, state.volume);
    take(body.gauge, state.gauge);
    take(body.stretch, state.stretch);
    take(body.stretch_99, state.stretch_99);
    take(body.contact_area, state.contact_area);
    take(body.contact_force, state.contact_force);
    body.highest.take(heights.highest);
    body.lowest.take(heights.lowest);
    body.audit = std::max(body.audit, std::abs(state.audit));
    body.substeps += state.substeps;
    body.air_skipped += state.air_skipped ? 1 : 0;
  }
}

ordered_json SheetRecorder::json() const {
  ordered_json list = ordered_json::array();
  for (const Body& body : bodies_) {
    list.push_back({{"name", player_.scene().deformables[body.index].name},
                    {"points", player_.deformable(body.index).points().size()},
                    {"area", player_.sheet(body.index)->area()},
                    {"bubbles", body.bubbles.json()},
                    {"volume", body.volume.json()},
                    {"gauge", body.gauge.json()},
                    {"stretch", body.stretch.json()},
                    {"stretch_99", body.stretch_99.json()},
                    {"contact_area", body.contact_area.json()},
                    {"contact_force", body.contact_force.json()},
                    {"highest", body.highest.json()},
                    {"lowest", body.lowest.json()},
                    {"air_audit_largest", body.audit},
                    {"substeps", body.substeps},
                    {"frames_without_air", body.air_skipped}});
  }
  return list;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
