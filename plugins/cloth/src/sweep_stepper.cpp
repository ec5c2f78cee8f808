#include "sweep_stepper.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "softpoint/core/instruction_set.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

const SweepKernelTable& kernels_of_machine() {
  switch (best_instruction_set()) {
    case InstructionSet::kAvx512:
      return *sweep_kernels_avx512();
    case InstructionSet::kAvx2:
      return *sweep_kernels_avx2();
    case InstructionSet::kBaseline:
      break;
  }
  return *sweep_kernels_baseline();
}

template <class T>
const SweepKernels<T>& sweep_kernels();
template <>
const SweepKernels<float>& sweep_kernels<float>() {
  return kernels_of_machine().single;
}
template <>
const SweepKernels<double>& sweep_kernels<double>() {
  return kernels_of_machine().dual;
}

template <class T>
const MarchKernels<T>& march_kernels();
const MarchKernelTable& march_kernels_of_machine() {
  const InstructionSet set = best_instruction_set();
  return set == InstructionSet::kAvx512 ? *march_kernels_avx512()
         : set == InstructionSet::kAvx2 ? *march_kernels_avx2()
                                        : *march_kernels_baseline();
}
template <>
const MarchKernels<float>& march_kernels<float>() {
  return march_kernels_of_machine().single;
}
template <>
const MarchKernels<double>& march_kernels<double>() {
  return march_kernels_of_machine().dual;
}

// x += by, in single without loss; as go() of the kernels.
inline void go(float& x, float& low, float by) {
  const float step = low + by, to = x + step, taken = to - x;
  low = (x - (to - taken)) + (step - taken);
  x = to;
}
inline void go(double& x, double&, double by) { x += by; }

}  // namespace

#include "stepper_inputs-inl.h"
// after inputs
#include "stepper_air-inl.h"
// after both
#include "stepper_alone-inl.h"
#include "stepper_coarse-inl.h"
#include "stepper_guard-inl.h"
#include "stepper_march-inl.h"
#include "stepper_march_load-inl.h"
#include "stepper_report-inl.h"
#include "stepper_sweep-inl.h"

template <class T>
SweepStepper<T>::SweepStepper(std::shared_ptr<ClothInputs> inputs)
    : ClothStepper(std::move(inputs)),
      kernels_(sweep_kernels<T>()),
      arrays_(in_->layout),
      data_(arrays_.data(in_->fabric.compression_ratio)),
      march_kernels_(march_kernels<T>()),
      march_bytes_(march_kernels_of_machine().bytes) {
  using A = SweepArrays<T>;
  T* inertia = arrays_.field(A::kInertia);
  std::fill_n(inertia, arrays_.slots, T(1));
  for (int slot : in_->layout.slot_of) arrays_.field(A::kFree)[slot] = T(1);
  std::fill_n(arrays_.field(A::kLevel), arrays_.slots, T(-1));
  std::fill_n(arrays_.tile_pocket.get(), arrays_.slots / kTile, -1);
  std::fill_n(arrays_.slot_pocket.get(), arrays_.slots, -1);
  set_positions(in_->pattern.points);
}

// How fast springs turn and stretch, 1/s, root mean square.
template <class T>
double SweepStepper<T>::turn_rate() const {
  using A = SweepArrays<T>;
  const T *u = arrays_.field(A::kW), *v = arrays_.field(A::kW + 1), *w = arrays_.field(A::kW + 2);
  double sum = 0;
  for (const Spring& spring : in_->pattern.springs) {
    const int a = in_->layout.slot_of[spring.a], b = in_->layout.slot_of[spring.b];
    const T x = u[a] - u[b], y = v[a] - v[b], z = w[a] - w[b];
    sum += double(x * x + y * y + z * z) / (spring.rest * spring.rest);
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, in_->pattern.springs.size())));
}

template <class T>
int SweepStepper<T>::begin_frame(double dt) {
  const ClothSettings& dial = in_->settings;
  dt_ = dt;
  double fastest = 0;
  for (const Hand& hand : hands_) {
    fastest = std::max({fastest, 1.5 * (hand.to - hand.from).norm() / dt, hand.to_velocity.norm()});
  }
  for (const PointContacts& contacts : in_->contacts) {
    for (int k = 0; k < contacts.count; ++k) {
      fastest = std::max(fastest, std::abs(contacts.planes[k].velocity.dot(contacts.planes[k].normal)));
    }
  }
  marches_ = marches();
  const double rate = turn_rate();
  rounds_ = static_cast<int>(std::clamp(rate / kRoundTurn, 1.0, double(kMostRounds)));
  const double moves = dial.max_move > 0 ? fastest * dt / (dial.max_move * in_->pattern.spacing) : 0.0;
  const auto steps = [&](double parts) {
    const double wanted = std::max(parts * dt / dial.max_substep, moves);
    return static_cast<int>(std::ceil(std::clamp(wanted - 1e-9, 1.0, double(dial.max_substeps))));
  };
  const int sweeps = steps(std::clamp(rate / kCalmTurn, 1.0, kMostTurns));
  const int count = marches_ && !in_->meets_itself ? std::min(sweeps, steps(kMarchPart)) : sweeps;
  parts_ = (sweeps + count - 1) / count;
  h_ = dt / count;
  coarse_made_ = march_off_ = false;
  march_fresh_ = true;
  contacts_time_ -= time_;
  hands_time_ -= time_;
  time_ = 0;
  ++profile.frames;
  return count;
}

// Forces of this small step, and their mean since the frame began.
template <class T>
void SweepStepper<T>::report() {
  using A = SweepArrays<T>;
  const T share = static_cast<T>(h_ / (time_ + h_));
  for (int k = 0; k < 3 && has_planes_; ++k) {
    const T* c = arrays_.field(A::kC + k);
    T* mean = arrays_.field(A::kM + k);
    for (long i = 0; i < arrays_.slots; ++i) mean[i] += share * (c[i] - mean[i]);
  }
  for (Hand& hand : hands_) {
    if (!marched_) hand.impulse += h_ * force_of(hand);
  }
}

template <class T>
void SweepStepper<T>::substep() {
  const bool changed = masses_dirty_ || forces_dirty_ || springs_dirty_ || air_dirty_ || set_anew_;
  load_inputs();
  load_hands();
  if (in_->settings.guard && changed) {
    if (air_) measure_air();
    double kinetic = 0;
    energy_ = total_energy(&kinetic);
    work_ = 0, unchecked_ = 0, set_anew_ = false;
  }
  marched_ = march();
  if (marched_) {
    report();
    time_ += h_;
    ++profile.substeps;
  } else {
    solve_parts();
  }
  for (std::size_t p = 0; p < pocket_states_.size(); ++p) pocket_states_[p] = {volumes_[p], gauges_[p]};
}

template <class T>
void SweepStepper<T>::end_frame() {
  for (Hand& hand : hands_) {
    hand.from = hand.limited ? Vec3(local(hand.slot) + origin_) : hand.to;
    hand.from_velocity = hand.limited ? vector_at(SweepArrays<T>::kW, hand.slot) : hand.to_velocity;
  }
}

std::unique_ptr<ClothStepper> make_stepper(std::shared_ptr<ClothInputs> inputs) {
  if (inputs->settings.precision == Precision::kDouble) {
    return std::make_unique<SweepStepper<double>>(std::move(inputs));
  }
  return std::make_unique<SweepStepper<float>>(std::move(inputs));
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
