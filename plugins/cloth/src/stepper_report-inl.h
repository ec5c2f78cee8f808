// What can be read of a cloth. Included by sweep_stepper.cpp only.

template <class T>
Vec3 SweepStepper<T>::position(int point) const {
  return local(in_->layout.slot_of[point]) + origin_;
}

template <class T>
Vec3 SweepStepper<T>::velocity(int point) const {
  return vector_at(SweepArrays<T>::kW, in_->layout.slot_of[point]);
}

template <class T>
Vec3 SweepStepper<T>::contact_force(int point) const {
  return vector_at(SweepArrays<T>::kC, in_->layout.slot_of[point]);
}

template <class T>
bool SweepStepper<T>::touching(int point) const {
  return arrays_.field(SweepArrays<T>::kTouch)[in_->layout.slot_of[point]] > T(0);
}

template <class T>
Vec3 SweepStepper<T>::mean_contact_force(int point) const {
  return vector_at(SweepArrays<T>::kM, in_->layout.slot_of[point]);
}

// Gradient of the energy of springs, bending, weight and air at a point, N; with inertia and dampers when
// `dynamic`.
template <class T>
Vec3 SweepStepper<T>::gradient(int slot, bool dynamic) const {
  using A = SweepArrays<T>;
  const SweepLayout& layout = in_->layout;
  const ColourPlan& plan = layout.colours[colour_of(slot)];
  const int tile = (slot - plan.first) / kTile, lane = (slot - plan.first) % kTile;
  const Vec3 x = local(slot);
  Vec3 g = dynamic
               ? Vec3(double(arrays_.field(A::kInertia)[slot]) * (x - started(slot) - vector_at(A::kT, slot)))
               : Vec3(-double(arrays_.field(A::kMass)[slot]) * vector_at(A::kF, slot));
  const auto neighbour = [&](const int* offset, const int* index, int count, int k) {
    return offset != nullptr ? slot + offset[k] : index[(tile * count + k) * kTile + lane];
  };
  Vec3 arms[kMaxRing];
  for (int k = 0; k < plan.ring; ++k) {
    const T* spring = arrays_.springs.get() + plan.spring_at + (tile * plan.ring + k) * 4L * kTile + lane;
    arms[k] = local(neighbour(plan.offset, plan.index, plan.ring, k)) - x;
    const double length = arms[k].norm();
    if (length == 0) continue;
    const double longer = length - spring[kTile];
    const double stiff = longer > 0 ? spring[0] : spring[0] * in_->fabric.compression_ratio;
    const double damped = dynamic ? spring[2 * kTile] * length - spring[3 * kTile] : 0;
    g -= (stiff * longer + damped) / length * arms[k];
  }
  for (int k = 0; k < plan.bends; ++k) {
    const double w = arrays_.bend_weight[plan.bend_at + (tile * plan.bends + k) * kTile + lane];
    g += w * (local(neighbour(plan.bend_offset, plan.bend_index, plan.bends, k)) - x);
  }
  const int pocket = air_ ? arrays_.slot_pocket[slot] : -1;
  if (pocket < 0) return g;
  Vec3 area = vector_at(A::kE, slot);
  for (int k = 0; k < plan.faces; ++k) {
    const double w = arrays_.face_weight[plan.face_at + (tile * plan.faces + k) * kTile + lane];
    area += w * arms[plan.face_j[k]].cross(arms[plan.face_k[k]]);
  }
  return g - gauges_[pocket] * area;
}

// What a hand pushes its point with, inertia and dampers included, N. What the sweeps have left unsolved at a
// point whose hand is of limited force is not the hand's.
template <class T>
Vec3 SweepStepper<T>::force_of(const Hand& hand) const {
  const Vec3 force = hand.mass > 0 ? Vec3(hand.mass / (h_ * h_) * (hand.at - local(hand.slot)))
                                   : gradient(hand.slot, true) - vector_at(SweepArrays<T>::kC, hand.slot);
  const double size = force.norm();
  return hand.limited && size > hand.max_force ? Vec3(hand.max_force / size * force) : force;
}

template <class T>
Vec3 SweepStepper<T>::hand_force(int hand) const {
  return gradient(hands_[hand].slot, false);
}

template <class T>
Vec3 SweepStepper<T>::hand_impulse(int hand) const {
  return hands_[hand].impulse;
}

template <class T>
double SweepStepper<T>::kinetic_energy() const {
  using A = SweepArrays<T>;
  double energy = 0;
  for (int slot : in_->layout.slot_of) {
    energy += 0.5 * arrays_.field(A::kMass)[slot] * vector_at(A::kW, slot).squaredNorm();
  }
  return energy;
}

template <class T>
double SweepStepper<T>::mechanical_energy() const {
  using A = SweepArrays<T>;
  double energy = kinetic_energy();
  for (const ColourPlan& plan : in_->layout.colours) energy += kernels_.elastic_energy(data_, plan);
  for (int slot : in_->layout.slot_of) {
    energy -= arrays_.field(A::kMass)[slot] * vector_at(A::kF, slot).dot(local(slot) + origin_);
  }
  return energy;
}

template <class T>
double SweepStepper<T>::potential_energy() const {
  return mechanical_energy() - kinetic_energy() + (air_ ? air_energy() : 0);
}
