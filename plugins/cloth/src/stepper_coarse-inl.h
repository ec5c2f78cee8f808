// The coarse correction: what the sweeps are slow at, the whole cloth going somewhere. Included by
// sweep_stepper.cpp only.

// Of the springs as they lie; once a frame will do, since the line search measures what it is worth.
template <class T>
void SweepStepper<T>::assemble_coarse() {
  using A = SweepArrays<T>;
  const SweepLayout& layout = in_->layout;
  if (coarse_ == nullptr) coarse_ = std::make_unique<CoarseLevel>(in_->pattern, in_->settings.coarse_points);
  const int n = in_->pattern.point_count();
  moves_.resize(n);
  inertia_.resize(n);
  const T *free = arrays_.field(A::kFree), *touch = arrays_.field(A::kTouch),
          *inertia = arrays_.field(A::kInertia);
  for (int p = 0; p < n; ++p) {
    const int slot = layout.slot_of[p];
    moves_[p] = free[slot] != T(0) && touch[slot] != T(1);
    inertia_[p] = moves_[p] ? double(inertia[slot]) : 0;
  }
  coarse_->begin(inertia_);
  const std::vector<Spring>& springs = in_->pattern.springs;
  const double damping = in_->fabric.damping_time / h_;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    const Spring& spring = springs[s];
    if (!moves_[spring.a] && !moves_[spring.b]) continue;
    const Vec3 r = local(layout.slot_of[spring.b]) - local(layout.slot_of[spring.a]);
    const double length = std::max(r.norm(), 1e-12), longer = length - spring.rest;
    const double stiff = spring.stiffness * (in_->stiffness_factors.empty() ? 1 : in_->stiffness_factors[s]);
    const double tangent = longer > 0 ? stiff : stiff * in_->fabric.compression_ratio;
    const double lateral = std::max(0.0, tangent * longer / length);
    const double along = (tangent + stiff * damping - lateral) / (length * length);
    const double h[6] = {lateral + along * r.x() * r.x(), lateral + along * r.y() * r.y(),
                         lateral + along * r.z() * r.z(), along * r.x() * r.y(),
                         along * r.x() * r.z(),           along * r.y() * r.z()};
    coarse_->add_spring(static_cast<int>(s), h, moves_[spring.a] != 0, moves_[spring.b] != 0);
  }
  for (std::size_t b = 0; b < in_->pattern.bends.size(); ++b) {
    coarse_->add_bend(static_cast<int>(b), in_->pattern.bends[b].stiffness, moves_);
  }
  coarse_ready_ = coarse_->factor();
}

// Pressures of the volumes as they are.
template <class T>
void SweepStepper<T>::measure_air() {
  if (!air_) return;
  measure_volumes();
  // Where there is no air, the sign of a rounding would decide: as it was.
  for (std::size_t p = 0; p < gauges_.size(); ++p) {
    if (in_->pockets[p].air > 0) solve_gauge(p, {});
  }
}

// Goes on along the moves, by so many times them.
template <class T>
void SweepStepper<T>::move_along(double part) {
  using A = SweepArrays<T>;
  const T scale = static_cast<T>(part);
  for (int k = 0; k < 3; ++k) {
    T *x = arrays_.field(A::kX + k), *low = arrays_.field(A::kLow + k);
    const T* d = arrays_.field(A::kD + k);
    for (long i = 0; i < arrays_.slots; ++i) go(x[i], low[i], scale * d[i]);
  }
  measure_air();
}

// The coarse nodes' way into the moves of the points.
template <class T>
void SweepStepper<T>::carry(std::span<const double> way) {
  using A = SweepArrays<T>;
  const T *touch = arrays_.field(A::kTouch), *carried = arrays_.field(A::kCarried);
  T *dx = arrays_.field(A::kD), *dy = arrays_.field(A::kD + 1), *dz = arrays_.field(A::kD + 2);
  for (int p = 0; p < in_->pattern.point_count(); ++p) {
    const int slot = in_->layout.slot_of[p];
    Vec3 d = Vec3::Zero();
    if (carried[slot] != T(0)) {
      d = coarse_->value_at(way, p);
      if (touch[slot] == T(2)) {
        const Vec3 normal = vector_at(A::kN, slot);
        d -= normal.dot(d) * normal;
      }
    }
    dx[slot] = static_cast<T>(d.x()), dy[slot] = static_cast<T>(d.y()), dz[slot] = static_cast<T>(d.z());
  }
}

template <class T>
void SweepStepper<T>::coarse_step() {
  using A = SweepArrays<T>;
  const SweepLayout& layout = in_->layout;
  if (!coarse_ready_) return;
  ++profile.coarse_steps;
  measure_air();
  const double* gauges = air_ ? gauges_.data() : nullptr;
  for (const ColourPlan& plan : layout.colours) kernels_.push(data_, plan, gauges);
  const T* carried = arrays_.field(A::kCarried);
  const int n = in_->pattern.point_count();
  const std::span<double> right = coarse_->right_side();
  std::fill(right.begin(), right.end(), 0.0);
  for (int p = 0; p < n; ++p) {
    const int slot = layout.slot_of[p];
    if (carried[slot] != T(0)) coarse_->add_to(right, p, vector_at(A::kB, slot));
  }
  pull_.assign(right.begin(), right.end());
  coarse_->solve(right);
  // Each bubble resists a change of its volume with kappa = p/V: a matrix of rank one each, by Sherman and
  // Morrison one after the other.
  for (std::size_t i = 0; i < gauges_.size() && air_; ++i) {
    const AirPocket& pocket = in_->pockets[i];
    const double p = pocket.ambient + gauges_[i];
    if (pocket.open || pocket.air <= 0 || volumes_[i] <= 0 || p * volumes_[i] < 0.999 * pocket.air) continue;
    bubble_.assign(right.size(), 0.0);
    for (int q = 0; q < n; ++q) {
      const int slot = layout.slot_of[q];
      if (carried[slot] != T(0) && arrays_.slot_pocket[slot] == static_cast<int>(i)) {
        coarse_->add_to(bubble_, q, vector_at(A::kV, slot));
      }
    }
    bubble_way_ = bubble_;
    coarse_->solve(bubble_way_);
    double gg = 0, gr = 0;
    for (std::size_t k = 0; k < right.size(); ++k)
      gg += bubble_[k] * bubble_way_[k], gr += bubble_[k] * right[k];
    const double kappa = p / volumes_[i];
    const double factor = kappa * gr / (1 + kappa * gg);
    for (std::size_t k = 0; k < right.size(); ++k) right[k] -= factor * bubble_way_[k];
  }
  double before = 0;
  for (std::size_t k = 0; k < right.size(); ++k) before += pull_[k] * right[k];
  if (!(before > 0)) return;
  carry(right);
  move_along(1);
  const auto push_here = [&] {
    double push = 0;
    for (const ColourPlan& plan : layout.colours) push += kernels_.push_along(data_, plan, gauges);
    return push;
  };
  // Taken as straight between its ends, the push along the way is zero here.
  const double after = push_here();
  double part = std::clamp(before / std::max(before - after, 1e-3 * before), 0.0, 1.5), here = 1;
  // Friction is not straight: what slides by less than the way is held by it long before its end.
  if (after < -kOvershoot * before) {
    double low = 0, push_low = before, high = 1, push_high = after;
    for (int round = 0; round < kSearchRounds; ++round) {
      part = low + (high - low) * push_low / (push_low - push_high);
      move_along(part - here);
      here = part;
      const double push = push_here();
      if (std::abs(push) < kOvershoot * before) break;
      (push > 0 ? low : high) = part;
      (push > 0 ? push_low : push_high) = push;
      (push > 0 ? push_high : push_low) *= 0.5;  // so that both ends close in
      part = low;
    }
  }
  move_along(part - here);
  if (part > 0.05) ++profile.coarse_taken;
}
