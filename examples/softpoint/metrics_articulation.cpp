#include "metrics_articulation.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace softpoint::inline SOFTPOINT_ABI::scene {

using nlohmann::ordered_json;

void ArticulationRecorder::Extremes::take(double value) {
  least = std::min(least, value);
  largest = std::max(largest, value);
}

ArticulationRecorder::ArticulationRecorder(const Player& player) : player_(player) {
  for (std::size_t k = 0; k < player.deformable_count(); ++k) {
    const Articulation* const articulation = player.articulation(k);
    if (articulation == nullptr) continue;
    Body body;
    body.index = k;
    body.start = body.now = articulation->measure();
    body.volume = {body.start.volume, body.start.volume};
    for (const ArticulationState::Part& part : body.start.parts) {
      body.length.push_back({part.length, part.length});
      body.bend.push_back({part.bend, part.bend});
    }
    bodies_.push_back(std::move(body));
  }
}

void ArticulationRecorder::record() {
  for (Body& body : bodies_) {
    body.now = player_.articulation(body.index)->measure();
    body.gap = std::max(body.gap, body.now.gap);
    body.kink = std::max(body.kink, body.now.kink);
    body.residual = std::max(body.residual, body.now.residual);
    body.iterations = std::max(body.iterations, body.now.iterations);
    body.unbalanced += body.now.balanced ? 0 : 1;
    body.solved += body.now.segments_solved;
    body.volume.take(body.now.volume);
    for (std::size_t p = 0; p < body.now.parts.size(); ++p) {
      body.length[p].take(body.now.parts[p].length);
      body.bend[p].take(body.now.parts[p].bend);
    }
    for (const ArticulationState::End& end : body.now.held) {
      const auto known = std::find_if(body.forces.begin(), body.forces.end(),
                                      [&](const auto& force) { return force.first == end.name; });
      if (known == body.forces.end()) {
        body.forces.emplace_back(end.name, end.force.norm());
      } else {
        known->second = std::max(known->second, end.force.norm());
      }
    }
  }
}

ordered_json ArticulationRecorder::json() const {
  ordered_json list = ordered_json::array();
  for (const Body& body : bodies_) {
    const DeformableSpec& spec = player_.scene().deformables[body.index];
    const Articulation& articulation = *player_.articulation(body.index);
    ordered_json parts = ordered_json::array(), forces = ordered_json::object();
    for (std::size_t p = 0; p < body.length.size(); ++p) {
      parts.push_back({{"name", spec.parts[p]},
                       {"length",
                        {{"rest", body.start.parts[p].length},
                         {"least", body.length[p].least},
                         {"largest", body.length[p].largest},
                         {"end", body.now.parts[p].length}}},
                       {"bend", {{"largest", body.bend[p].largest}, {"end", body.now.parts[p].bend}}}});
    }
    for (const auto& [name, largest] : body.forces) {
      forces[name] = {{"largest", largest}};
    }
    for (const ArticulationState::End& end : body.now.held) {
      forces[end.name]["end"] = {end.force.x(), end.force.y(), end.force.z()};
    }
    const double rest = body.start.volume;
    list.push_back({{"name", spec.name},
                    {"segments", articulation.segments()},
                    {"vertices", articulation.visible_points()},
                    {"triangles", articulation.visible_faces()},
                    {"gap", body.gap},
                    {"kink", {{"largest", body.kink}, {"end", body.now.kink}}},
                    {"volume",
                     {{"rest", rest},
                      {"least_change", body.volume.least / rest - 1.0},
                      {"largest_change", body.volume.largest / rest - 1.0},
                      {"end_change", body.now.volume / rest - 1.0}}},
                    {"parts", parts},
                    {"end_forces", forces},
                    {"iterations_largest", body.iterations},
                    {"residual_largest", body.residual},
                    {"frames_unbalanced", body.unbalanced},
                    {"segments_computed", body.solved}});
  }
  return list;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
