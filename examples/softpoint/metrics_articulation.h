#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Measures the bodies of parts of a scene, frame by frame.
class ArticulationRecorder {
 public:
  // Takes the rest pose.
  explicit ArticulationRecorder(const Player& player);

  // After each step.
  void record();

  // A list of objects, one a body of parts.
  nlohmann::ordered_json json() const;

 private:
  struct Extremes {
    double least = 0, largest = 0;
    void take(double value);
  };
  struct Body {
    std::size_t index = 0;
    ArticulationState start, now;
    double gap = 0, kink = 0, residual = 0;
    int iterations = 0, unbalanced = 0, frames_solved = 0;
    Extremes volume;
    std::vector<Extremes> length, bend;                  // of each part
    std::vector<std::pair<std::string, double>> forces;  // N, the largest on each end that was held
    long long solved = 0;                                // segments
  };

  const Player& player_;
  std::vector<Body> bodies_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
