// A small step of a grid by many explicit ones: cheap enough to be so short that springs, rim and wrinkles
// move by their own mass. Included by sweep_stepper.cpp only.

// Whether small steps of this frame are to be taken so: over one bubble with air, the others open. Dry cloth
// is left to the sweeps, whose energy never rises.
template <class T>
bool SweepStepper<T>::marches() {
  march_pocket_ = -1;
  if (in_->settings.march_step <= 0 || in_->pattern.columns == 0) return false;
  int closed = 0;
  for (std::size_t p = 0; p < in_->pockets.size(); ++p) {
    if (in_->pockets[p].open) continue;
    if (++closed > 1 || in_->pockets[p].air <= 0) return false;
    march_pocket_ = static_cast<int>(p);
  }
  if (closed == 0) return false;
  if (march_ == nullptr) march_ = std::make_unique<MarchGrid<T>>(in_->pattern, march_bytes_);
  if (!march_->usable()) return false;
  // As soft_air, before anything is measured: flat, at ambient pressure.
  double mass = 0;
  for (double of_point : in_->masses) mass += of_point;
  const AirPocket& pocket = in_->pockets[march_pocket_];
  const double step = in_->settings.march_step * march_->area() * pocket.ambient;
  return step * step < mass * pocket.air;
}

// Whether this small step may be taken so. What moves by itself, is held between two planes or has a bubble
// too stiff for explicit steps is left to the sweeps.
template <class T>
bool SweepStepper<T>::may_march() {
  const double longest = in_->settings.march_step;
  if (!marches_ || march_off_ || planes_move_ || !wedges_.empty() || !strays_.empty()) return false;
  for (const Hand& hand : hands_) {
    if (hand.mass > 0) return false;
  }
  march_count_ = static_cast<int>(std::ceil(h_ / longest - 1e-9));
  const double h = h_ / march_count_;
  march_share_ = kMarchMargin * h * (h + 2 * in_->fabric.damping_time) / 4;
  // The stiffer the cloth the wider accelerations are smoothed: by no more than a sixteenth of its side, and
  // by no more points than a hand that holds one of them bears.
  const double side = std::min(march_->data().columns, march_->data().rows) - 1;
  const double most = kMostSmoothed * std::max(1.0, side * side / (49 * 49));
  if (march_share_ * stiffest_ > std::min(most, kMostSmoothedAtAll)) return false;
  return true;
}

// Where a hand is at `time` after the start of the frame; cubic, as load_hands.
template <class T>
Vec3 SweepStepper<T>::hand_at(const Hand& hand, double time) const {
  const double t = std::min(1.0, time / dt_);
  const double b = t * t * (3 - 2 * t), c = t * (1 - t) * (1 - t), d = t * t * (t - 1);
  return hand.from + b * (hand.to - hand.from) + dt_ * (c * hand.from_velocity + d * hand.to_velocity) -
         origin_;
}

template <class T>
Vec3 SweepStepper<T>::march_vector(T* const* field, const Hand& hand) const {
  const long at = march_->at(hand.point);
  return Vec3(field[0][at], field[1][at], field[2][at]);
}

// A point that a hand holds goes where the hand goes, whatever was smoothed into it. What that adds to the
// sum of g . v.
template <class T>
double SweepStepper<T>::hold(const Hand& hand, double h) {
  MarchData<T>& d = march_->data();
  const long at = march_->at(hand.point);
  double more = 0;
  for (int k = 0; k < 3; ++k) {
    const double speed = hand.speed[k] + hand.change[k], other = speed - double(d.v[k][at]);
    more += other * double(d.g[k][at]);
    d.v[k][at] = static_cast<T>(speed);
    if constexpr (sizeof(T) == 4) {
      d.x[k][at] += static_cast<int>(std::lrint(h * other / double(d.unit)));
    } else {
      d.x[k][at] += h * other;
    }
  }
  return more;
}

// False, with everything as it was, if the energy says that this was no way.
template <class T>
bool SweepStepper<T>::march() {
  using A = SweepArrays<T>;
  if (!may_march()) return false;
  begin_air();
  choose_unit();
  if (march_dirty_) load_march();
  load_motion();
  MarchData<T>& d = march_->data();
  const double h = h_ / march_count_;
  const T step = static_cast<T>(h);
  for (int k = 0; k < 3; ++k) std::fill_n(d.c[k], d.rows * d.stride, T(0));
  march_kernels_.factor(d, static_cast<T>(march_share_ / d.unit));
  march_work_ = 0;
  solve_gauge(march_pocket_, {});
  for (Hand& hand : hands_) hand.impulse = Vec3::Zero();
  for (int s = 0; s < march_count_; ++s) {
    const T gauge = static_cast<T>(gauges_[march_pocket_]);
    march_kernels_.push(d, s % kGradientEvery == 0 ? MarchAir::kMeasured : MarchAir::kKept,
                        s == 0 ? MarchRate::kVelocity : MarchRate::kLength, gauge, step);
    if (s == 0 && !soft_air(h)) {
      march_off_ = true;  // nothing was changed yet
      return false;
    }
    for (Hand& hand : hands_) {
      const long at = march_->at(hand.point);
      const Vec3 to = hand_at(hand, time_ + (s + 1) * h);
      const double mass = d.mass[at];
      for (int k = 0; k < 3; ++k) {
        const double x = double(d.unit) * double(d.x[k][at]);
        hand.change[k] = (to[k] - x) / h - double(d.v[k][at]);
        hand.push[k] = mass / h * (hand.change[k] - double(d.f[k][at]));
      }
      const double size = hand.push.norm();
      hand.holds = !hand.limited || size <= hand.max_force;
      if (!hand.holds) hand.push *= hand.max_force / size;
      for (int k = 0; k < 3; ++k) d.f[k][at] += static_cast<T>(h / mass * hand.push[k]);
      hand.impulse += h * hand.push;
    }
    for (Hand& hand : hands_) hand.speed = march_vector(d.v, hand);
    double swept = march_kernels_.move(d, step);
    for (Hand& hand : hands_) {
      if (hand.holds) swept += hold(hand, h);
      march_work_ += h * hand.push.dot(march_vector(d.v, hand));
    }
    // The pressure of half a step later damps what bounces on the air.
    const double volume = volumes_[march_pocket_] + h * swept;
    volumes_[march_pocket_] = volume + h / 2 * swept;
    solve_gauge(march_pocket_, {});
    volumes_[march_pocket_] = volume;
  }
  copy_places(A::kX, A::kLow, A::kS, A::kStartLow);
  std::copy_n(arrays_.field(A::kW), 3 * arrays_.slots, arrays_.field(A::kQ));
  std::fill_n(arrays_.field(A::kLow), 3 * arrays_.slots, T(0));
  const T part = T(1) / static_cast<T>(march_count_);
  T* touch = arrays_.field(A::kTouch);
  for (int p = 0; p < in_->pattern.point_count(); ++p) {
    const int slot = in_->layout.slot_of[p];
    const long at = march_->at(p);
    touch[slot] = d.touch[at];
    for (int k = 0; k < 3; ++k) {
      arrays_.field(A::kX + k)[slot] = d.unit * static_cast<T>(d.x[k][at]);
      arrays_.field(A::kW + k)[slot] = d.v[k][at];
      arrays_.field(A::kC + k)[slot] = part * d.c[k][at];
    }
  }
  for (const Hand& hand : hands_) {
    if (!hand.limited) place(hand.slot, hand.at);
  }
  measure_volumes();
  solve_gauge(march_pocket_, {});
  fresh_ = true;
  profile.marched += march_count_;
  if (guard_march()) return true;
  ++profile.march_refused;
  march_off_ = march_fresh_ = true;
  copy_places(A::kS, A::kStartLow, A::kX, A::kLow);
  std::copy_n(arrays_.field(A::kQ), 3 * arrays_.slots, arrays_.field(A::kW));
  measure_volumes();
  solve_gauge(march_pocket_, {});
  double kinetic = 0;
  energy_ = total_energy(&kinetic);
  work_ = 0, unchecked_ = 0;
  return false;
}

// Whether a bubble's own frequency is low enough for steps of `h`.
template <class T>
bool SweepStepper<T>::soft_air(double h) const {
  const MarchData<T>& d = march_->data();
  const AirPocket& pocket = in_->pockets[march_pocket_];
  const double volume = volumes_[march_pocket_];
  if (!(volume > 0)) return false;
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    T part = 0;
    for (long i = 0; i < d.rows * d.stride; ++i) part += d.g[k][i] * d.g[k][i] * d.inverse_mass[i];
    sum += part;
  }
  return h * h * (pocket.ambient + gauges_[march_pocket_]) / volume * sum < 1;
}

// As guard(), of a small step that was marched: what it has too much is taken out of the velocities if it is
// little, else the small step is refused.
template <class T>
bool SweepStepper<T>::guard_march() {
  before_ = work_;
  work_ += march_work_;
  if (!in_->settings.guard) return true;
  unchecked_ = 0;
  ++profile.guard_checks;
  const double rounding = sizeof(T) == 4 ? 1e-7 : 1e-13;
  double kinetic = 0;
  double energy = total_energy(&kinetic);
  const double excess = energy - energy_ - work_ - rounding * (std::abs(energy_) + std::abs(work_));
  calm_ = excess <= 0 ? calm_ + 1 : 0;
  if (!(excess <= 0)) {
    // Smoothed accelerations carry energy of their own: a little may come back, and is owed.
    double weight = 0;
    for (double mass : in_->masses) weight += mass * in_->gravity.norm();
    const double half = 0.5 * payable(), credit = 1e-3 * weight * in_->pattern.spacing;
    if (!(excess <= half + credit)) return false;
    ++profile.guard_damped;
    const double taken = std::min(excess, half);
    damp(taken);
    energy -= excess;
  }
  energy_ = energy;
  work_ = 0;
  return true;
}
