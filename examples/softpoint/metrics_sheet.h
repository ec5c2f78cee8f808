#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Measures the cloths of a scene, frame by frame.
class SheetRecorder {
 public:
  // Takes the start.
  explicit SheetRecorder(const Player& player);

  // After each step.
  void record();

  // A list of objects, one a cloth.
  nlohmann::ordered_json json() const;

 private:
  struct Range {
    double least = 0, largest = 0, now = 0;
    void start(double value) { least = largest = now = value; }
    void take(double value);
    nlohmann::ordered_json json() const;
  };
  struct Body {
    std::size_t index = 0;
    Range bubbles, volume, gauge, stretch, stretch_99, contact_area, contact_force, highest, lowest;
    double start_air = 0, audit = 0;
    long long substeps = 0;
    int air_skipped = 0;  // frames
  };

  const Player& player_;
  std::vector<Body> bodies_;
};

// The least and the largest height (m) of a body's points.
struct Heights {
  double lowest = 0, highest = 0;
};
Heights heights_of(const Deformable& body);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
