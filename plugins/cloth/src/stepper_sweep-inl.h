// A small step by implicit Euler and sweeps. Included by sweep_stepper.cpp only.

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
    T *x = arrays_.field(A::kX + k), *low = arrays_.field(A::kLow + k), *t = arrays_.field(A::kT + k);
    T *s = arrays_.field(A::kS + k), *s_low = arrays_.field(A::kStartLow + k);
    T *q = arrays_.field(A::kQ + k), *r = arrays_.field(A::kR + k);
    const T *w = arrays_.field(A::kW + k), *f = arrays_.field(A::kF + k);
    for (long i = 0; i < arrays_.slots; ++i) {
      const T back = past * order[i];  // without a branch: it runs over all points
      const T from = back * ((x[i] - s[i]) + (low[i] - s_low[i])), speed = w[i] + back * (w[i] - q[i]);
      s[i] = x[i];
      s_low[i] = low[i];
      q[i] = w[i];
      r[i] = from;
      const T far = scale + order[i] * (scale2 - scale), long_step = h + order[i] * (h2 - h);
      t[i] = from + far * (speed + long_step * f[i]);
      go(x[i], low[i], free[i] * (h * w[i]));
    }
  }
  for (const Hand& hand : hands_) {
    if (!hand.limited) place(hand.slot, hand.at);
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
    const T *x = arrays_.field(A::kX + k), *low = arrays_.field(A::kLow + k), *r = arrays_.field(A::kR + k);
    const T *s = arrays_.field(A::kS + k), *s_low = arrays_.field(A::kStartLow + k);
    T* w = arrays_.field(A::kW + k);
    for (long i = 0; i < arrays_.slots; ++i)
      w[i] = ((x[i] - s[i]) + (low[i] - s_low[i]) - r[i]) * (inverse + order[i] * (inverse2 - inverse));
  }
}

// A small step by sweeps; one that explicit steps were meant for is too long for them and is cut.
template <class T>
void SweepStepper<T>::solve_parts() {
  using A = SweepArrays<T>;
  for (Hand& hand : hands_) hand.impulse = Vec3::Zero();
  if (parts_ > 1) {
    for (int k = 0; k < 3; ++k) std::fill_n(arrays_.field(A::kL + k), arrays_.slots, T(0));
  }
  const double whole = h_;
  h_ = whole / parts_;
  for (int part = 0; part < parts_; ++part) {
    if (parts_ > 1) load_inputs(), load_hands();
    solve();
    report();
    time_ += h_;
    ++profile.substeps;
    for (int k = 0; k < 3 && parts_ > 1; ++k) {
      T *c = arrays_.field(A::kC + k), *sum = arrays_.field(A::kL + k);
      for (long i = 0; i < arrays_.slots; ++i) sum[i] += c[i] / static_cast<T>(parts_);
      if (part + 1 == parts_) std::copy_n(sum, arrays_.slots, c);
    }
  }
  h_ = whole;
}

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
