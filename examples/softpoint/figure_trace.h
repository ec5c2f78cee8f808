#pragma once

#include <string>

#include "softpoint/figure/figure_stepper.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// A figure's motion as a table: t; if its base is free qw, qx, qy, qz, px, py, pz (the base's frame), wx, wy,
// wz, vx, vy, vz (world axes); q0, q1, ... of all other joints in the model's order, a ball as four; qd0,
// qd1,
// ...; energy. SI units; every number reads back as the same double.
class FigureTrace {
 public:
  explicit FigureTrace(const figure::FigureModel& model);  // refused: more than one free joint
  void add(double time, figure::FigureStepper& stepper);
  const std::string& csv() const { return csv_; }

 private:
  int base_q_ = -1, base_v_ = -1;  // where the base's numbers begin
  std::string csv_;
};

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
