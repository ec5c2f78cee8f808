// Points that are solved by themselves: held with a limited force, or between two planes. Included by
// sweep_stepper.cpp only.

// The move of a point that would cross `plane`: sticks, else slides; equations (7) to (9). `dx` without
// contact.
template <class T>
Vec3 SweepStepper<T>::stick_or_slide(const ContactPlane& plane, int slot, const Vec3& dx, const Mat3& h,
                                     Vec3& force, T& state) const {
  const Vec3 x = local(slot), n = plane.normal;
  const Vec3 foot = plane.foot + plane.velocity * (time_ + h_ - contacts_time_) - origin_;
  const double level = n.dot(foot);
  force = Vec3::Zero();
  state = T(0);
  if (n.dot(x + dx) >= level) return dx;
  Vec3 held = started(slot) + plane.velocity * h_;
  held += (level - n.dot(held)) * n - x;
  const Vec3 stick = h * (held - dx);
  const double press = n.dot(stick);
  const Vec3 shear = stick - press * n;
  const double limit = plane.friction * (press + plane.adhesion);
  if (press >= 0 && shear.norm() <= limit) {
    force = stick;
    state = T(1);
    return held;
  }
  // As slide() of the kernels.
  const Vec3 t = n.unitOrthogonal(), u = n.cross(t);
  const Vec3 ht = h * t, hu = h * u;
  const double bt = -t.dot(stick), bu = -u.dot(stick), size = std::hypot(bt, bu) + 1e-60;
  Vec3 slip = Vec3::Zero();
  double tau = 0;
  for (int round = 0; round < 12; ++round) {
    const double p = t.dot(ht) + tau, q = u.dot(hu) + tau, r = t.dot(hu);
    const double st = (q * bt - r * bu) / (p * q - r * r), su = (p * bu - r * bt) / (p * q - r * r);
    slip = st * t + su * u;
    const double pull = plane.friction * std::max(0.0, press + n.dot(h * slip) + plane.adhesion);
    const double a = size / (slip.norm() + 1e-60) - tau;
    tau = std::max(0.0, a * pull) / std::max(size - pull, 1e-9 * size);
  }
  force = stick + h * slip;
  state = T(2);
  return held + slip;
}

template <class T>
void SweepStepper<T>::solve_alone(int slot, const Hand* hand, const PointContacts* contacts) {
  using A = SweepArrays<T>;
  const T* hs = arrays_.field(A::kH) + slot;
  const long n = arrays_.slots;
  Mat3 h;
  h << hs[0], hs[3 * n], hs[4 * n], hs[3 * n], hs[n], hs[5 * n], hs[4 * n], hs[5 * n], hs[2 * n];
  Vec3 g = vector_at(A::kG, slot);
  const Mat3 own = h;
  const double pull = hand != nullptr ? hand->mass / (h_ * h_) : 0.0;
  h.diagonal().array() += pull;
  const int pocket = air_ ? arrays_.slot_pocket[slot] : -1;
  const Vec3 area = pocket >= 0 ? vector_at(A::kV, slot) : Vec3::Zero();
  if (pocket >= 0) {
    // Boyle's law for this point alone.
    const Vec3 b = h.inverse() * area;
    const double kept = gauges_[pocket];
    solve_gauge(pocket, {area.dot(b), area.dot(h.inverse() * g), 0});
    g -= gauges_[pocket] * area;
    gauges_[pocket] = kept;
  }
  const Vec3 there = hand != nullptr ? Vec3(hand->at - local(slot)) : Vec3::Zero();
  Vec3 dx = h.inverse() * (pull * there - g), force = Vec3::Zero();
  T state = T(0);
  if (hand != nullptr && pull > 0) {
    const Vec3 need = pull * (there - dx);
    const double size = need.norm();
    if (size > hand->max_force) dx = own.inverse() * (need * (hand->max_force / size) - g);
  } else if (hand != nullptr) {
    const Vec3 need = h * (there - dx);
    const double size = need.norm();
    dx = size <= hand->max_force ? there : Vec3(dx + h.inverse() * need * (hand->max_force / size));
  }
  if (contacts != nullptr && contacts->count > 0) {
    const Vec3 free = dx;
    dx = stick_or_slide(contacts->planes[0], slot, free, h, force, state);
    if (contacts->count > 1) {
      // One plane after the other, each against what the other one pushes with: a few rounds are enough.
      Vec3 forces[2] = {force, Vec3::Zero()};
      T states[2] = {state, T(0)};
      for (int round = 0; round < 20; ++round) {
        const int k = (round + 1) % 2;
        const Vec3 others = free + h.inverse() * forces[1 - k];
        dx = stick_or_slide(contacts->planes[k], slot, others, h, forces[k], states[k]);
      }
      force = forces[0] + forces[1];
      state = std::max(states[0], states[1]);
    }
  }
  set_vector(A::kC, slot, force);
  arrays_.field(A::kTouch)[slot] = state;
  place(slot, local(slot) + dx);
  if (pocket >= 0) volumes_[pocket] += area.dot(dx);
}
