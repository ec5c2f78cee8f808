#pragma once

#include <vector>

#include "curve_plot.h"
#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Air, force and stretch of a scene's cloths over time, as a picture.
class SheetCurves {
 public:
  explicit SheetCurves(const Player& player);

  // Whether there is a cloth, and so anything to draw.
  bool wanted() const { return !sheets_.empty(); }
  // Once for the start and after each step.
  void record();
  picture::Image image() const;

 private:
  const Player& player_;
  std::vector<std::size_t> sheets_;
  std::vector<double> times_;
  std::vector<CurvePanel> panels_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
