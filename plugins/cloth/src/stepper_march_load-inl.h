// What explicit steps are given: the cloth as the sweeps hold it, into the rows of a grid. Included by
// sweep_stepper.cpp only.

// The length that places are counted in: single precision keeps three bits for where points may go.
template <class T>
void SweepStepper<T>::choose_unit() {
  if constexpr (sizeof(T) == 4) {
    T farthest = 0;
    for (int k = 0; k < 3; ++k) {
      const T* x = arrays_.field(SweepArrays<T>::kX + k);
      for (int slot : in_->layout.slot_of) farthest = std::max(farthest, std::abs(x[slot]));
    }
    int exponent = 0;
    std::frexp(farthest, &exponent);
    const T unit = std::ldexp(T(1), exponent + 2 - 31), now = march_->data().unit;
    if (march_fresh_ || !(unit <= now && unit * 8 >= now)) {
      if (2 * unit != now) march_dirty_ = true;
      march_->set_unit(2 * unit);
      march_fresh_ = march_feet_ = true;
    }
  }
}

// All that is the same for the whole frame.
template <class T>
void SweepStepper<T>::load_march() {
  using A = SweepArrays<T>;
  MarchGrid<T>& grid = *march_;
  const double unit = grid.data().unit;
  for (std::size_t s = 0; s < in_->pattern.springs.size(); ++s) {
    const double factor = in_->stiffness_factors.empty() ? 1.0 : in_->stiffness_factors[s];
    grid.stiffness[grid.springs()[s].array][grid.springs()[s].at] =
        static_cast<T>(unit * factor * in_->pattern.springs[s].stiffness);
  }
  for (std::size_t f = 0; f < in_->pattern.faces.size(); ++f) {
    const int pocket = in_->face_pocket.empty() ? -1 : in_->face_pocket[f];
    const bool closed = pocket >= 0 && !in_->pockets[pocket].open;
    grid.faces_weight[grid.faces()[f].array][grid.faces()[f].at] =
        closed ? static_cast<T>(unit * unit * in_->pockets[pocket].side / 6) : T(0);
  }
  MarchData<T>& d = grid.data();
  d.compression = static_cast<T>(in_->fabric.compression_ratio);
  d.damping_time = static_cast<T>(in_->fabric.damping_time);
  d.drag_rate = static_cast<T>(in_->fabric.drag_rate);
  for (int p = 0; p < in_->pattern.point_count(); ++p) {
    const int slot = in_->layout.slot_of[p];
    const long at = grid.at(p);
    grid.mass[at] = arrays_.field(A::kMass)[slot];
    grid.inverse_mass[at] = T(1) / grid.mass[at];
    const bool plane = !in_->contacts.empty() && in_->contacts[p].count > 0;
    grid.friction[at] = plane ? arrays_.field(A::kFriction)[slot] : T(0);
    grid.adhesion[at] = plane ? arrays_.field(A::kAdhesion)[slot] : T(0);
    for (int k = 0; k < 3; ++k) {
      grid.acceleration[k][at] = arrays_.field(A::kF + k)[slot];
      grid.rim[k][at] = T(0);
      grid.normal[k][at] = plane ? arrays_.field(A::kN + k)[slot] : T(0);
    }
  }
  march_dirty_ = false;
  march_feet_ = true;
}

// Positions and velocities. Where a position is the one left here, the digits that it lost are kept.
template <class T>
void SweepStepper<T>::load_motion() {
  using A = SweepArrays<T>;
  MarchGrid<T>& grid = *march_;
  MarchData<T>& d = grid.data();
  const int points = in_->pattern.point_count();
  for (int k = 0; k < 3; ++k) {
    const T *x = arrays_.field(A::kX + k), *w = arrays_.field(A::kW + k);
    for (int p = 0; p < points; ++p) {
      const int slot = in_->layout.slot_of[p];
      const long at = grid.at(p);
      d.v[k][at] = w[slot];
      auto& place = d.x[k][at];
      if (march_fresh_ || static_cast<T>(d.unit * static_cast<T>(place)) != x[slot])
        place = place_of(x[slot]);
    }
  }
  if (march_feet_ && has_planes_) {
    for (int p = 0; p < points; ++p) {
      const long at = grid.at(p);
      if (in_->contacts[p].count == 0) continue;
      const ContactPlane& plane = in_->contacts[p].planes[0];
      const Vec3 x = local(in_->layout.slot_of[p]);
      const Vec3 foot = x - plane.normal.dot(x - (plane.foot - origin_)) * plane.normal;
      for (int k = 0; k < 3; ++k) grid.foot[k][at] = plane.normal[k] == 0 ? 0 : place_of(foot[k]);
    }
  }
  for (int slot : rim_slots_) {
    const long at = grid.at(in_->layout.point_of[slot]);
    for (int k = 0; k < 3; ++k) grid.rim[k][at] = arrays_.field(A::kE + k)[slot];
  }
  if (march_feet_) grid.compare_rows();
  march_fresh_ = march_feet_ = false;
}

template <class T>
typename MarchPlace<T>::Type SweepStepper<T>::place_of(double x) const {
  if constexpr (sizeof(T) == 4) {
    return static_cast<int>(std::lrint(std::clamp(x / double(march_->data().unit), -1e9, 1e9)));
  } else {
    return x;
  }
}
