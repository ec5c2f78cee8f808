// Pockets of air: their volumes, what closes them, Boyle's law for a colour. Included by sweep_stepper.cpp
// only.

// Which faces belong to which pocket, once a frame.
template <class T>
void SweepStepper<T>::load_air() {
  const SweepLayout& layout = in_->layout;
  const std::size_t count = in_->pockets.size();
  pocket_states_.resize(count);
  gauges_.resize(count, 0.0);
  volumes_.resize(count);
  change_.resize(count);
  sums_.resize(count);
  air_ = false;
  for (const AirPocket& pocket : in_->pockets) air_ = air_ || !pocket.open;
  for (std::size_t p = 0; p < count; ++p) {
    if (in_->pockets[p].open) gauges_[p] = 0;
  }
  rim_edges_.clear();
  strays_.clear();
  for (int slot : rim_slots_) set_vector(SweepArrays<T>::kE, slot, Vec3::Zero());
  rim_slots_.clear();
  std::fill_n(arrays_.slot_pocket.get(), layout.slots, -1);
  std::fill_n(arrays_.tile_pocket.get(), layout.slots / kTile, -1);
  std::fill_n(arrays_.face_weight.get(), layout.face_of.size(), T(0));
  if (!air_) return;
  move_origin(in_->air_origin);
  if (across_.empty()) find_neighbour_faces();
  const auto pocket_of = [this](int face) { return face < 0 ? -1 : in_->face_pocket[face]; };

  const std::vector<Triangle>& faces = in_->pattern.faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const int pocket = pocket_of(static_cast<int>(f));
    if (pocket < 0 || in_->pockets[pocket].open) continue;
    for (int k = 0; k < 3; ++k) {
      // The pocket of most of a point's faces would be fairest; that of its first does as well.
      int& of = arrays_.slot_pocket[layout.slot_of[faces[f][k]]];
      if (of < 0) of = pocket;
      if (pocket_of(across_[f][k]) != pocket)
        rim_edges_.push_back({faces[f][k], faces[f][(k + 1) % 3], pocket});
    }
  }
  for (std::size_t c = 0; c < layout.colours.size(); ++c) {
    const ColourPlan& plan = layout.colours[c];
    const std::vector<int>& in_volume = layout.volume_colours;
    const bool counts =
        in_volume.empty() || std::find(in_volume.begin(), in_volume.end(), c) != in_volume.end();
    for (int tile = 0; tile < plan.tiles; ++tile) {
      const int first = plan.first + tile * kTile;
      int& tile_pocket = arrays_.tile_pocket[first / kTile];
      for (int lane = 0; lane < kTile; ++lane) {
        const int own = arrays_.slot_pocket[first + lane];
        if (own < 0) continue;
        tile_pocket = tile_pocket == -1 || tile_pocket == own ? own : -2;
        for (int k = 0; k < plan.faces; ++k) {
          const long at = plan.face_at + (static_cast<long>(tile) * plan.faces + k) * kTile + lane;
          const int face = layout.face_of[at];
          const int pocket = pocket_of(face);
          if (pocket < 0 || in_->pockets[pocket].open) continue;
          if (pocket == own) {
            arrays_.face_weight[at] = static_cast<T>(in_->pockets[pocket].side / 6);
          } else {
            const Triangle& t = faces[face];
            const int point = layout.point_of[first + lane];
            const int corner = t[0] == point ? 0 : t[1] == point ? 1 : 2;
            strays_.push_back({first + lane, layout.slot_of[t[(corner + 1) % 3]],
                               layout.slot_of[t[(corner + 2) % 3]], pocket, counts});
          }
        }
      }
    }
    // A tile whose slots share a pocket or have none may be summed at once: weights of those without are 0.
  }
  for (const RimEdge& edge : rim_edges_) {
    rim_slots_.push_back(layout.slot_of[edge.a]);
    rim_slots_.push_back(layout.slot_of[edge.b]);
  }
  for (const RimQuad& quad : in_->rims) {
    rim_slots_.push_back(layout.slot_of[quad.a]);
    rim_slots_.push_back(layout.slot_of[quad.b]);
  }
  std::sort(rim_slots_.begin(), rim_slots_.end());
  rim_slots_.erase(std::unique(rim_slots_.begin(), rim_slots_.end()), rim_slots_.end());
}

template <class T>
void SweepStepper<T>::find_neighbour_faces() {
  const std::vector<Triangle>& faces = in_->pattern.faces;
  std::map<std::pair<int, int>, int> face_of;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) face_of[{faces[f][k], faces[f][(k + 1) % 3]}] = static_cast<int>(f);
  }
  across_.resize(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto found = face_of.find({faces[f][(k + 1) % 3], faces[f][k]});
      across_[f][k] = found == face_of.end() ? -1 : found->second;
    }
  }
  // Never again within a step: the most there can be.
  const std::size_t points = in_->pattern.points.size();
  rim_edges_.reserve(3 * faces.size());
  strays_.reserve(3 * faces.size());
  rim_slots_.reserve(6 * faces.size() + points);
}

// What open fans and rim quads add to dV/dx, taken at the start of the small step: they hardly move within.
template <class T>
void SweepStepper<T>::add_rims() {
  using A = SweepArrays<T>;
  const SweepLayout& layout = in_->layout;
  for (int slot : rim_slots_) set_vector(A::kE, slot, Vec3::Zero());
  const auto add = [&](int point, int pocket, const Vec3& v) {
    const int slot = layout.slot_of[point];
    if (arrays_.slot_pocket[slot] != pocket) return;
    for (int k = 0; k < 3; ++k) arrays_.field(A::kE + k)[slot] += static_cast<T>(v[k]);
  };
  for (const RimEdge& edge : rim_edges_) {
    const Vec3 half = -in_->pockets[edge.pocket].side / 6 *
                      local(layout.slot_of[edge.a]).cross(local(layout.slot_of[edge.b]));
    add(edge.a, edge.pocket, half);
    add(edge.b, edge.pocket, half);
  }
  for (const RimQuad& quad : in_->rims) {
    if (in_->pockets[quad.pocket].open) continue;
    // The patch b, a, foot_a, foot_b seen from outside; equation (5).
    const Vec3 p = local(layout.slot_of[quad.b]), q = local(layout.slot_of[quad.a]);
    const Vec3 &r = quad.foot_a, &s = quad.foot_b;
    const double side = in_->pockets[quad.pocket].side / 12;
    add(quad.b, quad.pocket, side * (q.cross(r) + r.cross(s) + q.cross(s)));
    add(quad.a, quad.pocket, side * (r.cross(p) + s.cross(p) + r.cross(s)));
  }
}

template <class T>
void SweepStepper<T>::measure_volumes() {
  const SweepLayout& layout = in_->layout;
  std::fill(volumes_.begin(), volumes_.end(), 0.0);
  double share = 1;
  if (layout.volume_colours.empty()) {
    for (const ColourPlan& plan : layout.colours) kernels_.volume(data_, plan, volumes_.data());
    share = 1. / 3;
  } else {
    for (int c : layout.volume_colours) kernels_.volume(data_, layout.colours[c], volumes_.data());
  }
  for (const StrayFace& stray : strays_) {
    if (!stray.counts) continue;
    volumes_[stray.pocket] +=
        in_->pockets[stray.pocket].side * cone(local(stray.slot), local(stray.j), local(stray.k));
  }
  for (double& volume : volumes_) volume *= share;
  for (std::size_t p = 0; p < volumes_.size(); ++p)
    volumes_[p] += in_->pockets[p].side * in_->pockets[p].closure;
  for (const RimQuad& quad : in_->rims) {
    const AirPocket& pocket = in_->pockets[quad.pocket];
    if (pocket.open) continue;
    volumes_[quad.pocket] += pocket.side * cone(local(layout.slot_of[quad.b]), local(layout.slot_of[quad.a]),
                                                quad.foot_a, quad.foot_b);
  }
}

// Points between two pockets feel the second one as it was.
template <class T>
void SweepStepper<T>::begin_air() {
  if (!air_) {
    ++profile.air_skipped;
    return;
  }
  using A = SweepArrays<T>;
  add_rims();
  measure_volumes();
  for (const StrayFace& stray : strays_) {
    const Vec3 push = gauges_[stray.pocket] * in_->pockets[stray.pocket].side / 6 *
                      local(stray.j).cross(local(stray.k)) / arrays_.field(A::kInertia)[stray.slot];
    for (int k = 0; k < 3; ++k) arrays_.field(A::kT + k)[stray.slot] += static_cast<T>(push[k]);
  }
}

// Pa; no pocket pushes harder, whatever a fold or a jump of its feet makes of its volume: Boyle's law has no
// bound, and no time step that follows it.
constexpr double kMostAtmospheres = 1e3;
inline double most_gauge(const AirPocket& pocket) {
  return std::min(pocket.max_gauge, kMostAtmospheres * std::max(pocket.ambient, 1.0));
}

// (p_a + q) (V* + q s) = K for the gauge pressure q; equation (6).
template <class T>
void SweepStepper<T>::solve_gauge(std::size_t i, const PocketSums& sums) {
  const AirPocket& pocket = in_->pockets[i];
  if (pocket.open) return;
  const double s = sums.stiff, v = volumes_[i] - sums.lag + sums.fixed;
  const double b = v + pocket.ambient * s, c = pocket.ambient * v - pocket.air;
  const double d = v - pocket.ambient * s;
  const double root = std::sqrt(d * d + 4 * s * pocket.air);
  double q = gauges_[i];
  if (b > 0) {
    q = -2 * c / (b + root);
  } else if (s > 0) {
    q = (root - b) / (2 * s);
  } else if (pocket.max_gauge <= 0) {
    q = pocket.max_gauge;  // a patch of which nothing wants to lift
  }
  // Without air there is nothing to push with, not even where a fold makes the volume negative.
  const double most = pocket.air > 0 ? most_gauge(pocket) : std::min(0.0, pocket.max_gauge);
  gauges_[i] = std::min(std::max({q, pocket.min_pressure - pocket.ambient, -pocket.max_suction}), most);
}

// p_a (V - V0) - K ln(V/V0) with V0 = K/p_a, where it is zero: the guard allows for rounding by the size of
// the energy, and K is a million times what moves the cloth. Straight where the pressure is at its least or
// at its most, so that it is bounded from below: a volume far below zero is no way to lose energy. J.
template <class T>
double SweepStepper<T>::air_energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < volumes_.size(); ++i) {
    const AirPocket& pocket = in_->pockets[i];
    if (pocket.open) continue;
    const double v = volumes_[i];
    const double least = std::max({pocket.min_pressure, pocket.ambient - pocket.max_suction, 0.0});
    if (pocket.air <= 0) {
      energy += (pocket.ambient - least) * std::max(v, 0.0);
      continue;
    }
    const double thin = least > 0 ? pocket.air / least : HUGE_VAL;  // from this volume on
    const double most = std::max(pocket.ambient + most_gauge(pocket), 1e-30);
    const double full = std::min(pocket.air / most, thin);  // up to this volume
    const double rest = pocket.air / std::max(pocket.ambient, 1e-30);
    const double at = std::clamp(v, full, thin), more = (at - rest) / rest;
    energy += pocket.ambient * (v - at) + pocket.air * (more - std::log1p(more));
    if (v > thin) energy -= least * (v - thin);
    if (v < full) energy += most * (full - v);
  }
  return energy;
}
