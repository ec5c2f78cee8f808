#include "figure_trace.h"

#include <fmt/format.h>

#include "figure_joints.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

FigureTrace::FigureTrace(const figure::FigureModel& model) {
  const int base = find_base(model);
  int positions = model.position_count(), velocities = model.velocity_count();
  csv_ = "t";
  if (base >= 0) {
    base_q_ = model.position_offset(base);
    base_v_ = model.velocity_offset(base);
    positions -= 7;
    velocities -= 6;
    csv_ += ",qw,qx,qy,qz,px,py,pz,wx,wy,wz,vx,vy,vz";
  }
  for (int k = 0; k < positions; ++k) csv_ += fmt::format(",q{}", k);
  for (int k = 0; k < velocities; ++k) csv_ += fmt::format(",qd{}", k);
  csv_ += ",energy\n";
}

void FigureTrace::add(double time, figure::FigureStepper& stepper) {
  const auto put = [&](double value) {
    csv_ += ',';
    csv_ += to_text(value);
  };
  // All numbers but the base's.
  const auto put_others = [&](const std::vector<double>& numbers, int base, int count) {
    for (int k = 0; k < static_cast<int>(numbers.size()); ++k) {
      if (base < 0 || k < base || k >= base + count) put(numbers[static_cast<std::size_t>(k)]);
    }
  };
  const figure::FigureState& state = stepper.state();
  csv_ += to_text(time);
  if (base_q_ >= 0) {
    const auto q = static_cast<std::size_t>(base_q_), v = static_cast<std::size_t>(base_v_);
    for (std::size_t k = 3; k < 7; ++k) put(state.q[q + k]);
    for (std::size_t k = 0; k < 3; ++k) put(state.q[q + k]);
    for (std::size_t k = 0; k < 6; ++k) put(state.qd[v + k]);
  }
  put_others(state.q, base_q_, 7);
  put_others(state.qd, base_v_, 6);
  put(stepper.energy());
  csv_ += '\n';
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
