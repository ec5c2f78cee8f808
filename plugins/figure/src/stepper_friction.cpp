// Dry friction of joints: |torque| <= c, against the motion. Half of a step's impulses before the step's
// motion and half after it, each a boxed complementarity problem with one solution, found by pivoting with
// one O(N) pass a pivot; what sticks and would not be torn loose stands through the step. (21) to (23) of
// doc/dynamics.md.
#include <algorithm>
#include <cmath>

#include "stepper_impl.h"

namespace softpoint::inline SOFTPOINT_ABI::figure {
namespace {

constexpr double kDryRounding = 1e-12;  // of the largest impulse or torque, velocity or acceleration

// Pivoting between sticking (0) and sliding with a sign: `wanted(i)` is where joint i belongs. Whole blocks
// first, then one by the least index.
template <class Pass, class Wanted>
bool settle(std::vector<signed char>& slides, Pass pass, Wanted wanted) {
  int best = static_cast<int>(slides.size()) + 1, patience = 5;
  const int most = 40 + 12 * static_cast<int>(slides.size());
  for (int round = 0; round < most; ++round) {
    pass();
    int wrong = 0;
    for (std::size_t i = 0; i < slides.size(); ++i) wrong += wanted(i) != slides[i];
    if (wrong == 0) return true;
    if (wrong < best) {
      best = wrong;
      patience = 5;
    } else {
      --patience;
    }
    for (std::size_t i = 0; i < slides.size(); ++i) {
      const signed char to = wanted(i);
      if (to == slides[i]) continue;
      slides[i] = to;
      if (patience < 0) break;
    }
  }
  return false;
}

signed char sign_or_zero(double x) { return static_cast<signed char>((x > 0) - (x < 0)); }

}  // namespace

bool FigureStepper::Impl::stands(const Dry& joint) const {
  return !chosen[static_cast<std::size_t>(joint.link)] || joint.stopped(stops);
}

// (21), (22): impulses of `length` s of friction on the velocities of a state.
void FigureStepper::Impl::rub(double length, FigureState& at) {
  std::fill(held.begin(), held.end(), 0);
  const Vec3 gravity = dynamics.gravity(), base = dynamics.base_acceleration();
  dynamics.set_gravity(Vec3::Zero());
  dynamics.set_base_acceleration(Vec3::Zero());
  bool any = false;
  for (std::size_t i = 0; i < dry.size(); ++i) {
    slides[i] = stands(dry[i]) ? 0 : sign_or_zero(at.qd[dry[i].v]);
    any = any || slides[i] != 0;
  }
  double impulse_scale = 0, rate_scale = 0;
  const auto pass = [&] {
    std::fill(dry_torque.begin(), dry_torque.end(), 0.0);
    std::fill(acceleration.begin(), acceleration.end(), 0.0);
    for (std::size_t i = 0; i < dry.size(); ++i) {
      if (stands(dry[i])) continue;
      held[i] = slides[i] == 0;
      if (held[i]) {
        acceleration[dry[i].v] = -at.qd[dry[i].v];
      } else {
        dry_torque[dry[i].v] = -slides[i] * length * dry[i].limit;
      }
    }
    set_joints();
    dynamics.forward(at.q.data(), still.data(), dry_torque.data(), acceleration.data());
    keep_rows(at, acceleration.data(), Keep::kRates);
    dynamics.inverse(at.q.data(), still.data(), acceleration.data(), torque.data(), pin_loads);
    impulse_scale = rate_scale = 0;
    for (const double t : torque) impulse_scale = std::max(impulse_scale, std::abs(t));
    for (std::size_t k = 0; k < at.qd.size(); ++k) rate_scale = std::max(rate_scale, std::abs(at.qd[k]));
  };
  const auto wanted = [&](std::size_t i) -> signed char {
    if (stands(dry[i])) return 0;
    const std::size_t v = dry[i].v;
    if (slides[i] == 0) {
      const bool held_back = std::abs(torque[v]) <= length * dry[i].limit + kDryRounding * impulse_scale;
      return held_back ? static_cast<signed char>(0) : sign_or_zero(-torque[v]);
    }
    const double after = at.qd[v] + acceleration[v];
    return slides[i] * after >= -kDryRounding * rate_scale ? slides[i] : static_cast<signed char>(0);
  };
  if (any && settle(slides, pass, wanted)) {
    for (std::size_t k = 0; k < at.qd.size(); ++k) at.qd[k] += acceleration[k];
    for (std::size_t k = 0; k < pins.size(); ++k) pin_impulses[k] += pin_loads[k].force;
    for (std::size_t i = 0; i < dry.size(); ++i) {
      double& rate = at.qd[dry[i].v];
      if (!stands(dry[i]) && (slides[i] == 0 || slides[i] * rate < 0)) rate = 0;
    }
  } else if (any) {
    ++counts.unfinished;
  }
  std::fill(held.begin(), held.end(), 0);
  dynamics.set_gravity(gravity);
  dynamics.set_base_acceleration(base);
  set_joints();
}

void FigureStepper::Impl::begin_with_friction(double dt) {
  std::copy(state.qd.begin(), state.qd.end(), before_friction.qd.begin());
  rub(0.5 * dt, state);
}

// The second half, on the step's end; a step that is not taken over leaves the state it found.
void FigureStepper::Impl::end_with_friction(double dt, bool good) {
  std::fill(held.begin(), held.end(), 0);
  set_joints();
  if (good) {
    rub(0.5 * dt, next);
  } else {
    std::copy(before_friction.qd.begin(), before_friction.qd.end(), state.qd.begin());
  }
}

// (23): joints at rest that their friction holds against everything else.
void FigureStepper::Impl::hold_at_rest() {
  bool any = false;
  for (std::size_t i = 0; i < dry.size(); ++i) {
    slides[i] = stands(dry[i]) ? 0 : sign_or_zero(state.qd[dry[i].v]);
    any = any || (!stands(dry[i]) && slides[i] == 0);
  }
  if (!any) return;
  double torque_scale = 0, rate_scale = 0;
  const auto pass = [&] {
    std::fill(dry_torque.begin(), dry_torque.end(), 0.0);
    for (std::size_t i = 0; i < dry.size(); ++i) {
      if (stands(dry[i])) continue;
      held[i] = slides[i] == 0;
      dry_torque[dry[i].v] = -slides[i] * dry[i].limit;
    }
    set_joints();
    if (!standing.empty()) prescribe(time, state, acceleration);
    answer(state, dry_torque.data(), acceleration.data());
    dynamics.inverse(state.q.data(), state.qd.data(), acceleration.data(), torque.data(), pin_loads);
    torque_scale = rate_scale = 0;
    for (const double t : torque) torque_scale = std::max(torque_scale, std::abs(t));
    for (const double a : acceleration) rate_scale = std::max(rate_scale, std::abs(a));
  };
  const auto wanted = [&](std::size_t i) -> signed char {
    const std::size_t v = dry[i].v;
    if (stands(dry[i]) || state.qd[v] != 0) return slides[i];
    if (slides[i] == 0) {
      const bool held_back = std::abs(torque[v]) <= dry[i].limit + kDryRounding * torque_scale;
      return held_back ? static_cast<signed char>(0) : sign_or_zero(-torque[v]);
    }
    return slides[i] * acceleration[v] >= -kDryRounding * rate_scale ? slides[i]
                                                                     : static_cast<signed char>(0);
  };
  if (!settle(slides, pass, wanted)) {
    ++counts.unfinished;
    std::fill(held.begin(), held.end(), 0);
    set_joints();
  }
}

}  // namespace softpoint::inline SOFTPOINT_ABI::figure
