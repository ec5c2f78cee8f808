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

}  // namespace

#include "stepper_inputs-inl.h"
// after inputs
#include "stepper_air-inl.h"
// after both
#include "stepper_alone-inl.h"
#include "stepper_coarse-inl.h"
#include "stepper_guard-inl.h"
#include "stepper_march-inl.h"
#include "stepper_report-inl.h"

template <class T>
SweepStepper<T>::SweepStepper(std::shared_ptr<ClothInputs> inputs)
    : ClothStepper(std::move(inputs)),
      kernels_(sweep_kernels<T>()),
      arrays_(in_->layout),
      data_(arrays_.data(in_->fabric.compression_ratio)),
      march_kernels_(march_kernels<T>()) {
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
  double wanted = dt / dial.max_substep * (marches_ ? 0.5 : std::clamp(rate / kCalmTurn, 1.0, kMostTurns));
  if (dial.max_move > 0) wanted = std::max(wanted, fastest * dt / (dial.max_move * in_->pattern.spacing));
  const int count = static_cast<int>(std::ceil(std::clamp(wanted - 1e-9, 1.0, double(dial.max_substeps))));
  h_ = dt / count;
  coarse_made_ = march_off_ = false;
  march_fresh_ = true;
  contacts_time_ -= time_;
  time_ = 0;
  ++profile.frames;
  return count;
}

// Inertia's target, and the start of the sweeps: the way goes on as it was. To start from the target instead,
// with gravity in, stretches cloth under tension thirty times more. Points that fly remember the small step
// before: of second order, equation (1); those that touch begin anew.
template <class T>
void SweepStepper<T>::predict() {
  using A = SweepArrays<T>;
  const double ratio = h_before_ > 0 && !fresh_ ? h_ / h_before_ : HUGE_VAL;
  const bool second = in_->settings.second_order && ratio <= 2;
  const T past = static_cast<T>(second ? ratio * ratio / (1 + 2 * ratio) : 0);
  shorter_ = second ? h_ * (1 + ratio) / (1 + 2 * ratio) : h_;
  const double rate = in_->fabric.drag_rate;
  const T h = static_cast<T>(h_), h2 = static_cast<T>(shorter_);
  const T scale = static_cast<T>(h_ / (1 + rate * h_)),
          scale2 = static_cast<T>(shorter_ / (1 + rate * shorter_));
  const T stiff = static_cast<T>((1 + rate * h_) / (h_ * h_));
  const T stiff2 = static_cast<T>((1 + rate * shorter_) / (shorter_ * shorter_));
  const T *free = arrays_.field(A::kFree), *mass = arrays_.field(A::kMass), *touch = arrays_.field(A::kTouch);
  const T allowed = second ? T(1) : T(0);
  T *inertia = arrays_.field(A::kInertia), *order = arrays_.field(A::kSecond);
  for (long i = 0; i < arrays_.slots; ++i) {
    order[i] = touch[i] == T(0) ? allowed * free[i] : T(0);
    inertia[i] = mass[i] * (stiff + order[i] * (stiff2 - stiff));
  }
  for (int k = 0; k < 3; ++k) {
    T *x = arrays_.field(A::kX + k), *s = arrays_.field(A::kS + k), *t = arrays_.field(A::kT + k);
    T *p = arrays_.field(A::kP + k), *q = arrays_.field(A::kQ + k), *r = arrays_.field(A::kR + k);
    const T *w = arrays_.field(A::kW + k), *f = arrays_.field(A::kF + k);
    for (long i = 0; i < arrays_.slots; ++i) {
      const T back = past * order[i];  // without a branch: it runs over all points
      const T from = x[i] + back * (x[i] - p[i]), speed = w[i] + back * (w[i] - q[i]);
      s[i] = p[i] = x[i];
      q[i] = w[i];
      r[i] = from;
      const T far = scale + order[i] * (scale2 - scale), long_step = h + order[i] * (h2 - h);
      t[i] = from + far * (speed + long_step * f[i]);
      x[i] += free[i] * (h * w[i]);
    }
  }
  for (const Hand& hand : hands_) {
    if (!hand.limited) set_vector(A::kX, hand.slot, hand.at);
  }
  h_before_ = h_;
  fresh_ = false;
}

template <class T>
void SweepStepper<T>::sweep_colour(int colour) {
  const ColourPlan& plan = in_->layout.colours[colour];
  std::fill(sums_.begin(), sums_.end(), PocketSums{});
  kernels_.gather(data_, plan, air_, sums_.data());
  if (air_) {
    ++profile.boyle_solves;
    for (std::size_t p = 0; p < sums_.size(); ++p) solve_gauge(p, sums_[p]);
    for (int round = 0; round < 3; ++round) {
      std::fill(sums_.begin(), sums_.end(), PocketSums{});
      if (kernels_.move(data_, plan, gauges_.data(), sums_.data()) == 0) break;
      if (round == 2) break;
      ++profile.boyle_repeats;
      for (std::size_t p = 0; p < sums_.size(); ++p) solve_gauge(p, sums_[p]);
    }
  } else {
    kernels_.move(data_, plan, nullptr, nullptr);
  }
  std::fill(change_.begin(), change_.end(), 0.0);
  farthest_ = std::max(farthest_, kernels_.commit(data_, plan, air_, change_.data()));
  for (std::size_t p = 0; p < change_.size(); ++p) volumes_[p] += change_[p];
  for (const Hand& hand : hands_) {
    if (!hand.limited || hand.colour != colour) continue;
    solve_alone(hand.slot, &hand, in_->contacts.empty() ? nullptr : &in_->contacts[hand.point]);
  }
  for (const Wedge& wedge : wedges_) {
    if (wedge.colour == colour) solve_alone(wedge.slot, nullptr, &in_->contacts[wedge.point]);
  }
}

template <class T>
void SweepStepper<T>::sweep() {
  const int count = static_cast<int>(in_->layout.colours.size());
  for (int colour = 0; colour < count; ++colour) sweep_colour(colour);
  ++profile.sweeps;
}

template <class T>
void SweepStepper<T>::finish() {
  using A = SweepArrays<T>;
  const T inverse = static_cast<T>(1 / h_), inverse2 = static_cast<T>(1 / shorter_);
  const T* order = arrays_.field(A::kSecond);
  for (int k = 0; k < 3; ++k) {
    const T *x = arrays_.field(A::kX + k), *r = arrays_.field(A::kR + k);
    T* w = arrays_.field(A::kW + k);
    for (long i = 0; i < arrays_.slots; ++i)
      w[i] = (x[i] - r[i]) * (inverse + order[i] * (inverse2 - inverse));
  }
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
    if (!marched_) hand.impulse = h_ * force_of(hand);
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
  if (!marched_) solve();
  report();
  for (std::size_t p = 0; p < pocket_states_.size(); ++p) pocket_states_[p] = {volumes_[p], gauges_[p]};
  time_ += h_;
  ++profile.substeps;
}

// A small step by implicit Euler and sweeps.
template <class T>
void SweepStepper<T>::solve() {
  predict();
  for (const ColourPlan& plan : in_->layout.colours) {
    kernels_.measure_dampers(data_, plan, arrays_.springs.get());
  }
  farthest_ = 0;
  begin_air();
  const int every = in_->settings.coarse_every;
  const bool coarse = every > 0 && profile.substeps % every == 0;
  if (every > 0 && !coarse_made_) assemble_coarse(), coarse_made_ = true;
  // The first sweep takes what is rough out of the way.
  const int first = coarse ? std::max(1, in_->settings.sweeps / 2) : 0;
  for (int i = 0; i < first; ++i) sweep();
  if (coarse) coarse_step();
  for (int i = 0; i < std::max(1, in_->settings.sweeps - first); ++i) sweep();
  // Over air they are dear, and bring little.
  for (int round = 1; coarse && !air_ && round < rounds_; ++round) {
    coarse_step();
    sweep();
  }
  finish();
  if (in_->settings.guard) guard();
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
