#pragma once

#include <string>

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A row a frame: time, energies, contacts, penetration, then per body that can move its centre of mass and
// velocity (and of a deformable its elastic energy, of a cloth its air and stretch), and per handle its force. SI units. Rows are the same
// for the same scene and precision.
class TraceRecorder {
 public:
  // Writes the header and the row of the start.
  explicit TraceRecorder(Player& player);

  // After each step.
  void record();

  const std::string& csv() const { return csv_; }

 private:
  void head();
  void row();

  Player& player_;
  std::string csv_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
