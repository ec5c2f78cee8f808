#pragma once

#include <span>

#include "softpoint/core/vec.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What a cloth measures now.
struct SheetState {
  int bubbles = 0;           // with a pressure of their own
  double volume = 0;         // m3, of those
  double gauge = 0;          // Pa, of the largest of those, over the atmosphere
  double air = 0;            // J, pressure times volume of all
  double vented = 0;         // J, left for the atmosphere less what came from it
  double audit = 0;          // J, air that is unaccounted for
  double stretch = 0;        // largest strain of warp and weft
  double stretch_99 = 0;     // 99 in 100 are less
  double stretch_mean = 0;   // of the sizes
  double contact_area = 0;   // m2, of points that press on something
  double contact_force = 0;  // N, sum of the sizes of their forces
  int substeps = 0;          // of the last step
  int marched = 0;           // of the last step, explicit ones
  bool air_skipped = false;  // nothing was done for air
};

// What a cloth brings beside its skin: numbers, and how wet it looks.
class Sheet {
 public:
  Sheet() = default;
  Sheet(const Sheet&) = delete;
  Sheet& operator=(const Sheet&) = delete;
  virtual ~Sheet() = default;

  virtual SheetState measure() const = 0;
  // One a point, 0 to 1.
  virtual std::span<const double> saturation() const = 0;
  virtual double area() const = 0;  // m2, at rest
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
