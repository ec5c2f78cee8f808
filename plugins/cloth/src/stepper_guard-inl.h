// The energy guard: a small step may not end with more energy than the last one checked had, plus the work of
// hands and moving colliders. Included by sweep_stepper.cpp only.

// Kinetic and potential energy; what hands hold exactly has no kinetic one. J.
template <class T>
double SweepStepper<T>::total_energy(double* kinetic) const {
  using A = SweepArrays<T>;
  const T* mass = arrays_.field(A::kMass);
  double moving = 0, weight = 0;
  for (long first = 0; first < arrays_.slots; first += kTile) {
    T k[kTile] = {}, g[kTile] = {};
    for (int c = 0; c < 3; ++c) {
      const T *x = arrays_.field(A::kX + c) + first, *w = arrays_.field(A::kW + c) + first;
      const T* f = arrays_.field(A::kF + c) + first;
      for (int i = 0; i < kTile; ++i) k[i] += w[i] * w[i], g[i] += f[i] * x[i];
    }
    for (int i = 0; i < kTile; ++i) {
      moving += double(mass[first + i]) * double(k[i]);
      weight += double(mass[first + i]) * double(g[i]);
    }
  }
  for (const Hand& hand : hands_) {
    if (!hand.limited) moving -= double(mass[hand.slot]) * vector_at(A::kW, hand.slot).squaredNorm();
  }
  *kinetic = moving / 2;
  double energy = *kinetic - weight + (air_ ? air_energy() : 0);
  for (const ColourPlan& plan : in_->layout.colours) energy += kernels_.elastic_energy(data_, plan);
  return energy;
}

// Work of hands and of surfaces that move, in this small step. J.
template <class T>
double SweepStepper<T>::work() const {
  using A = SweepArrays<T>;
  double sum = 0;
  for (const Hand& hand : hands_) {
    sum += force_of(hand).dot(local(hand.slot) - started(hand.slot));
  }
  if (!planes_move_) return sum;
  for (int slot : in_->layout.slot_of) sum += vector_at(A::kC, slot).dot(vector_at(A::kU, slot));
  return sum;
}

// Kinetic energy of what moves freely, as that of its mean velocity and of what is relative to it. Cloth that
// hands hold has no mean to keep.
template <class T>
typename SweepStepper<T>::Motion SweepStepper<T>::motion(int field) const {
  using A = SweepArrays<T>;
  const T *mass = arrays_.field(A::kMass), *free = arrays_.field(A::kFree);
  Motion out;
  double total = 0;
  for (int slot : in_->layout.slot_of) {
    if (free[slot] == T(0)) continue;
    total += mass[slot];
    out.mean += double(mass[slot]) * vector_at(field, slot);
  }
  out.mean *= total > 0 && hands_.empty() ? 1 / total : 0.0;
  out.of_mean = total * out.mean.squaredNorm() / 2;
  for (int slot : in_->layout.slot_of) {
    if (free[slot] == T(0)) continue;
    out.relative += 0.5 * double(mass[slot]) * (vector_at(field, slot) - out.mean).squaredNorm();
  }
  return out;
}

// What of an excess may be taken out of the velocities: all that is relative to the mean, and what the mean
// has gained in this small step; with a little of the mean for rounding.
template <class T>
double SweepStepper<T>::payable() const {
  using A = SweepArrays<T>;
  const Motion now = motion(A::kW), before = motion(A::kQ);
  return now.relative + std::max(0.0, now.of_mean - before.of_mean) + 1e-3 * now.of_mean;
}

// Takes `excess` (J) out of the velocity relative to the mean, then out of the mean.
template <class T>
void SweepStepper<T>::damp(double excess) {
  using A = SweepArrays<T>;
  const Motion now = motion(A::kW);
  const auto left = [](double energy, double taken) {
    return energy > taken ? std::sqrt(1 - taken / energy) : 0.0;
  };
  const double keep = left(now.relative, excess);
  const double rest = excess - now.relative;
  const Vec3 mean = (rest > 0 ? left(now.of_mean, rest) : 1.0) * now.mean;
  const T* free = arrays_.field(A::kFree);
  for (int slot : in_->layout.slot_of) {
    if (free[slot] != T(0)) set_vector(A::kW, slot, mean + keep * (vector_at(A::kW, slot) - now.mean));
  }
}

// Back to the start of the small step, at rest but for what hands do.
template <class T>
void SweepStepper<T>::restore() {
  using A = SweepArrays<T>;
  copy_places(A::kS, A::kStartLow, A::kX, A::kLow);
  for (const Hand& hand : hands_) {
    if (!hand.limited) place(hand.slot, hand.at);
  }
  measure_air();
}

template <class T>
void SweepStepper<T>::guard() {
  before_ = work_;
  work_ += work();
  const bool last = time_ + 1.5 * h_ > dt_;  // what is told next may change the energy
  const double wild = 0.25 * in_->pattern.spacing * in_->pattern.spacing;
  if (calm_ >= kCalm && ++unchecked_ < kCalmEvery && !last && farthest_ < wild) {
    ++profile.guard_skipped;
    return;
  }
  unchecked_ = 0;
  ++profile.guard_checks;
  const double rounding = sizeof(T) == 4 ? 1e-7 : 1e-13;
  double kinetic = 0;
  double energy = total_energy(&kinetic);
  const auto excess = [&] {
    return energy - energy_ - work_ - rounding * (std::abs(energy_) + std::abs(work_));
  };
  const auto fair = [&] { return excess() <= 0; };  // not when a number is not finite
  calm_ = fair() ? calm_ + 1 : 0;
  if (!fair() && std::isfinite(energy)) {
    ++profile.guard_sweeps;
    work_ -= work();
    sweep();
    finish();
    work_ += work();
    energy = total_energy(&kinetic);
  }
  if (!fair() && !(excess() <= payable())) {
    // The way there led uphill: from the start of the small step, where the energy was fair.
    ++profile.guard_restarts;
    const double before = work_;
    restore();
    for (int i = 0; i < 2 * in_->settings.sweeps; ++i) sweep();
    finish();
    work_ = before_ + work();
    energy = total_energy(&kinetic);
    if (!std::isfinite(before) || !std::isfinite(energy)) ++profile.non_finite;
  }
  if (!fair() && !(excess() <= payable())) {
    const Vec3 mean = motion(SweepArrays<T>::kQ).mean;
    restore();
    work_ = before_;
    finish();
    fresh_ = true;
    const T* free = arrays_.field(SweepArrays<T>::kFree);
    for (int k = 0; k < 3; ++k) {
      std::fill_n(arrays_.field(SweepArrays<T>::kC + k), arrays_.slots, T(0));
      T* w = arrays_.field(SweepArrays<T>::kW + k);
      const T drift = static_cast<T>(mean[k]);
      for (long i = 0; i < arrays_.slots; ++i) w[i] = free[i] == T(0) ? w[i] : drift;
    }
    energy = total_energy(&kinetic);
  }
  if (!fair()) {
    ++profile.guard_damped;
    damp(excess());
    energy = total_energy(&kinetic);
  }
  energy_ = energy;
  work_ = 0;
}
