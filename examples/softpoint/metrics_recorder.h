#pragma once

#include <string>
#include <vector>

#include "metrics_articulation.h"
#include "metrics_penetration.h"
#include "metrics_sheet.h"
#include "metrics_state.h"
#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Measures a scene in play, frame by frame. Costs nothing in the measured steps.
class MetricsRecorder {
 public:
  // Takes the state at the start.
  explicit MetricsRecorder(Player& player);

  // After each step.
  void record();

  const Penetration& penetration() const { return penetration_; }
  // All of it, as a JSON document.
  std::string json() const;

 private:
  struct Series {  // one value a frame
    std::vector<double> step, predict, detect, compliance, solve, commit, mirror, rest;
  };

  Player& player_;
  int first_frame_;
  MechanicalState start_, now_;
  double largest_momentum_change_ = 0, largest_angular_momentum_change_ = 0;
  double largest_energy_ = 0, least_energy_ = 0;
  Penetration penetration_;
  ArticulationRecorder articulations_;
  SheetRecorder sheets_;
  Series seconds_;
  FrameWork sum_, largest_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
