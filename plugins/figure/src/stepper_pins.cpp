// Steps of a figure whose points are pinned.
#include <algorithm>

#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kTorn = 1e-9;   // m
constexpr double kDriven = 0.1;  // of the kinetic energy and 1 J, in a step

}  // namespace

// Whether the pins hold in `next` and have not driven the figure: fixed points do no work.
bool FigureStepper::Impl::went_well(double energy) {
  if (!finite()) return false;
  for (const Pin& pin : pins) {
    const Vec3 now = pin.chain.evaluate(pin.at.point, next.q.data(), nullptr, nullptr).position;
    bool moves = false;
    for (const int link : pin.chain.links()) moves = moves || chosen[static_cast<std::size_t>(link)];
    if (moves && (now - pin.at.place).norm() > kTorn) return false;
  }
  if (motion != nullptr) return true;
  dynamics.place(next.q.data(), next.qd.data());
  const FigureMechanics sums = dynamics.mechanics();
  const double after = sums.kinetic_energy + sums.potential_energy;
  return after - energy <= kDriven * (1 + sums.kinetic_energy);
}

// A chain that is drawn taut, or legs that are stretched between their feet, cannot go on as they go, and
// forces of any size would not help: all rates vanish then, as in an inelastic blow.
void FigureStepper::Impl::move_with_pins(double dt) {
  const double began = time;
  dynamics.place(state.q.data(), state.qd.data());
  const FigureMechanics sums = dynamics.mechanics();
  const double energy = sums.kinetic_energy + sums.potential_energy;
  move(dt);
  if (went_well(energy)) return;
  ++counts.taut;
  time = began;
  std::fill(pin_impulses.begin(), pin_impulses.end(), Vec3::Zero());
  pinned_rates = state.qd;
  std::fill(state.qd.begin(), state.qd.end(), 0.0);
  std::fill(stops.begin(), stops.end(), Stop::kFree);
  set_joints();
  move(dt);
  if (!went_well(energy)) {
    next.q = state.q;
    next.qd = state.qd;
    time = began;
    if (!standing.empty()) prescribe(time + dt, next, acceleration);
  }
  state.qd = pinned_rates;  // should the step not be taken over
}

void FigureStepper::Impl::take_part() {
  for (std::size_t k = 0; k < pins.size(); ++k) pin_impulses[k] += part_impulses[k];
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
