// What the caller sets, into the arrays of the sweeps.
// Included by sweep_stepper.cpp only.
template <class T>
Vec3 SweepStepper<T>::vector_at(int field, int slot) const {
  return Vec3(arrays_.field(field)[slot], arrays_.field(field + 1)[slot], arrays_.field(field + 2)[slot]);
}

template <class T>
void SweepStepper<T>::set_vector(int field, int slot, const Vec3& v) {
  for (int k = 0; k < 3; ++k) arrays_.field(field + k)[slot] = static_cast<T>(v[k]);
}

template <class T>
Vec3 SweepStepper<T>::local(int slot) const {
  using A = SweepArrays<T>;
  return kTwo ? Vec3(vector_at(A::kX, slot) + vector_at(A::kLow, slot)) : vector_at(A::kX, slot);
}

// Where it was at the start of the small step.
template <class T>
Vec3 SweepStepper<T>::started(int slot) const {
  using A = SweepArrays<T>;
  return kTwo ? Vec3(vector_at(A::kS, slot) + vector_at(A::kStartLow, slot)) : vector_at(A::kS, slot);
}

template <class T>
void SweepStepper<T>::place(int slot, const Vec3& x) {
  using A = SweepArrays<T>;
  set_vector(A::kX, slot, x);
  if (kTwo) set_vector(A::kLow, slot, x - vector_at(A::kX, slot));
}

// The start of a small step to where all is now, or back.
template <class T>
void SweepStepper<T>::copy_places(int from, int from_low, int to, int to_low) {
  std::copy_n(arrays_.field(from), 3 * arrays_.slots, arrays_.field(to));
  if (kTwo) std::copy_n(arrays_.field(from_low), 3 * arrays_.slots, arrays_.field(to_low));
}

template <class T>
int SweepStepper<T>::colour_of(int slot) const {
  int c = static_cast<int>(in_->layout.colours.size()) - 1;
  while (slot < in_->layout.colours[c].first) --c;
  return c;
}

template <class T>
void SweepStepper<T>::set_positions(std::span<const Vec3> positions) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : positions) mean += p / static_cast<double>(positions.size());
  origin_ = in_->pockets.empty() ? mean : in_->air_origin;
  for (std::size_t p = 0; p < positions.size(); ++p) {
    place(in_->layout.slot_of[p], positions[p] - origin_);
  }
  contacts_dirty_ = set_anew_ = fresh_ = true;
}

template <class T>
void SweepStepper<T>::set_velocities(std::span<const Vec3> velocities) {
  set_anew_ = fresh_ = true;
  for (std::size_t p = 0; p < velocities.size(); ++p) {
    set_vector(SweepArrays<T>::kW, in_->layout.slot_of[p], velocities[p]);
  }
}

template <class T>
void SweepStepper<T>::move_origin(const Vec3& origin) {
  if (origin == origin_) return;
  const Vec3 shift = origin_ - origin;
  for (int slot : in_->layout.slot_of) place(slot, local(slot) + shift);
  origin_ = origin;
  contacts_dirty_ = set_anew_ = fresh_ = true;
}

template <class T>
void SweepStepper<T>::hands_changed() {
  // Hands that stay keep the way they came.
  const std::vector<ClothHand>& wanted = in_->hands;
  std::vector<Hand>& have = hands_;
  bool same = wanted.size() == have.size();
  for (std::size_t i = 0; same && i < wanted.size(); ++i) same = wanted[i].point == have[i].point;
  if (!same) {
    set_anew_ = true;
    for (const Hand& hand : have) arrays_.field(SweepArrays<T>::kFree)[hand.slot] = T(1);
    have.resize(wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      Hand& hand = have[i];
      hand.point = wanted[i].point;
      hand.slot = in_->layout.slot_of[hand.point];
      hand.colour = colour_of(hand.slot);
      hand.from = local(hand.slot) + origin_;
      hand.from_velocity = Vec3::Zero();
      arrays_.field(SweepArrays<T>::kFree)[hand.slot] = T(0);
    }
    contacts_dirty_ = true;  // points that were set free may have two planes
  }
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    have[i].to = wanted[i].target;
    have[i].to_velocity = wanted[i].velocity;
    have[i].max_force = wanted[i].max_force;
    have[i].mass = wanted[i].mass;
    have[i].limited = std::isfinite(wanted[i].max_force) || wanted[i].mass > 0;
    if (wanted[i].starts || wanted[i].mass > 0) {
      have[i].from = wanted[i].start;
      have[i].from_velocity = wanted[i].start_velocity;
    }
    if (wanted[i].mass > 0) have[i].to = wanted[i].start;
  }
  hands_time_ = time_;
}

template <class T>
void SweepStepper<T>::load_masses() {
  T* mass = arrays_.field(SweepArrays<T>::kMass);
  for (int slot = 0; slot < in_->layout.slots; ++slot) {
    const int point = in_->layout.point_of[slot];
    mass[slot] = point < 0 ? T(1) : static_cast<T>(in_->masses[point]);
  }
}

// Accelerations of constant forces; drag pulls towards the wind.
template <class T>
void SweepStepper<T>::load_forces() {
  const Vec3 same = in_->gravity + in_->fabric.drag_rate * in_->wind;
  for (int point = 0; point < in_->pattern.point_count(); ++point) {
    Vec3 a = same;
    if (!in_->forces.empty()) a += in_->forces[point] / in_->masses[point];
    set_vector(SweepArrays<T>::kF, in_->layout.slot_of[point], a);
  }
}

template <class T>
void SweepStepper<T>::load_springs() {
  const SweepLayout& layout = in_->layout;
  const double damping = in_->fabric.damping_time / h_;
  for (const ColourPlan& plan : layout.colours) {
    for (long group = 0; group < static_cast<long>(plan.tiles) * plan.ring; ++group) {
      T* out = arrays_.springs.get() + plan.spring_at + group * 4 * kTile;
      const int* of = layout.spring_of.data() + plan.spring_at / 4 + group * kTile;
      for (int lane = 0; lane < kTile; ++lane) {
        if (of[lane] < 0) continue;
        const Spring& spring = in_->pattern.springs[of[lane]];
        const double factor = in_->stiffness_factors.empty() ? 1.0 : in_->stiffness_factors[of[lane]];
        out[lane] = static_cast<T>(spring.stiffness * factor);
        out[kTile + lane] = static_cast<T>(spring.rest);
        out[2 * kTile + lane] = static_cast<T>(spring.stiffness * factor * damping);
      }
    }
  }
  springs_h_ = h_;
}

// What bounds the length of explicit steps: springs that pull along a row or a column, over the mass.
template <class T>
void SweepStepper<T>::find_stiffest() {
  stiffest_ = 0;
  for (std::size_t s = 0; s < in_->pattern.springs.size(); ++s) {
    const Spring& spring = in_->pattern.springs[s];
    const double factor = in_->stiffness_factors.empty() ? 1.0 : in_->stiffness_factors[s];
    stiffest_ = std::max(stiffest_,
                         factor * spring.stiffness / std::min(in_->masses[spring.a], in_->masses[spring.b]));
  }
}

template <class T>
void SweepStepper<T>::load_contacts() {
  using A = SweepArrays<T>;
  const SweepLayout& layout = in_->layout;
  std::fill_n(arrays_.tile_planes.get(), layout.slots / kTile, static_cast<signed char>(0));
  wedges_.clear();
  has_planes_ = planes_move_ = false;
  for (int point = 0; point < in_->pattern.point_count(); ++point) {
    const int slot = layout.slot_of[point];
    const int count = in_->contacts.empty() ? 0 : in_->contacts[point].count;
    if (count == 0) {
      set_vector(A::kN, slot, Vec3::Zero());
      set_vector(A::kU, slot, Vec3::Zero());
      arrays_.field(A::kLevel)[slot] = T(-1);
      arrays_.field(A::kTouch)[slot] = T(0);
      set_vector(A::kC, slot, Vec3::Zero());
      continue;
    }
    const ContactPlane& plane = in_->contacts[point].planes[0];
    const Vec3 foot = plane.foot + plane.velocity * (time_ + h_ - contacts_time_);
    set_vector(A::kN, slot, plane.normal);
    set_vector(A::kU, slot, plane.velocity * h_);
    arrays_.field(A::kLevel)[slot] = static_cast<T>(plane.normal.dot(foot - origin_));
    arrays_.field(A::kFriction)[slot] = static_cast<T>(plane.friction);
    arrays_.field(A::kAdhesion)[slot] = static_cast<T>(plane.adhesion);
    planes_move_ = planes_move_ || plane.velocity != Vec3::Zero();
    has_planes_ = true;
    arrays_.tile_planes[slot / kTile] = 1;
    if (count < 2 || held(slot)) continue;
    wedges_.push_back({point, slot, colour_of(slot)});
  }
  // What is solved by itself, the sweep leaves alone.
  T* free = arrays_.field(A::kFree);
  for (int slot : layout.slot_of) free[slot] = T(1);
  for (const Hand& hand : hands_) free[hand.slot] = T(0);
  for (const Wedge& wedge : wedges_) free[wedge.slot] = T(0);
}

template <class T>
bool SweepStepper<T>::held(int slot) const {
  for (const Hand& hand : hands_) {
    if (hand.slot == slot) return true;
  }
  return false;
}

template <class T>
void SweepStepper<T>::load_inputs() {
  march_dirty_ =
      march_dirty_ || air_dirty_ || masses_dirty_ || forces_dirty_ || springs_dirty_ || contacts_dirty_;
  if (masses_dirty_ || springs_dirty_) find_stiffest();
  if (air_dirty_) load_air();
  if (masses_dirty_) load_masses(), forces_dirty_ = true;
  if (forces_dirty_) load_forces();
  if (springs_dirty_ || springs_h_ != h_) load_springs();
  if (contacts_dirty_ || planes_move_) load_contacts();
  masses_dirty_ = forces_dirty_ = springs_dirty_ = contacts_dirty_ = air_dirty_ = false;
}

// Cubic from the state at the start of the frame to the target at its end.
template <class T>
void SweepStepper<T>::load_hands() {
  const double t = std::min(1.0, (time_ + h_) / dt_);
  for (Hand& hand : hands_) {
    if (hand.mass > 0) {
      hand.at = hand.from + (time_ + h_ - hands_time_) * hand.to_velocity - origin_;
      continue;
    }
    const double b = t * t * (3 - 2 * t), c = t * (1 - t) * (1 - t), d = t * t * (t - 1);
    const Vec3 at =
        hand.from + b * (hand.to - hand.from) + dt_ * (c * hand.from_velocity + d * hand.to_velocity);
    hand.at = at - origin_;
  }
}
