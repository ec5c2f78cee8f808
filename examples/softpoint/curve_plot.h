#pragma once

#include <string>
#include <vector>

#include "softpoint/picture/image.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A line over time.
struct Curve {
  std::string name;
  std::vector<double> values;  // one a time; what is not finite leaves a gap
};

// Curves of one unit over a common axis of time.
struct CurvePanel {
  std::string title;  // "volume, cm3"
  std::vector<Curve> curves;
};

// Round numbers that divide a range of values into 3 to 10 parts.
std::vector<double> round_ticks(double low, double high);

// All panels, one below the other. `times`: s.
picture::Image draw_curves(const std::vector<double>& times, const std::vector<CurvePanel>& panels);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
