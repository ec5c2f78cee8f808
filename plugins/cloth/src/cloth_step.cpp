// One step of a cloth, as a list of stages.
#include <algorithm>
#include <cmath>

#include "cloth_state.h"
#include "softpoint/core/near_colliders.h"
#include "softpoint/core/profile.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {
namespace {

// m; points may move this much more than they are seen to, before their planes are made anew.
constexpr double kSlack = 2e-3;

}  // namespace

void Cloth::advance_by(double dt, const Vec3& acceleration, NearColliders& near, std::span<HeldPoint> held) {
  State& s = *state_;
  s.profile = {};
  s.dt = dt;
  std::copy(positions_.begin(), positions_.end(), s.positions.begin());
  std::copy(velocities_.begin(), velocities_.end(), s.velocities.begin());
  if (s.paper) {
    s.advance_paper(dt, acceleration, near, held);
    end_positions_ = s.positions;
    return;
  }
  s.solver.set_gravity(acceleration);
  s.solver.set_wind(s.wind);
  s.self.counts = {};
  s.begin_self(held);

  s.gather(near, dt, acceleration);
  s.air_on = s.find_bubbles(near);
  s.solver.set_positions(s.positions);  // about the origin of the air
  s.solver.set_velocities(s.velocities);
  s.solver.set_contacts(s.gatherer.contacts());
  s.place_hands(dt, near, held);
  const int parts = s.solver.begin_frame(dt);
  const double h = dt / parts;
  s.self_energy = s.solver.mechanical_energy();
  for (int part = 0; part < parts; ++part) {
    near.begin(h);
    if (part > 0) {
      s.follow(near, dt - part * h, held);
      s.carry_air(near);
    }
    {
      StageTimer timer(s.profile.seconds.solve);
      s.solver.substep();
      std::swap(s.before, s.positions);
      s.solver.positions(s.positions);
      s.solver.velocities(s.velocities);
    }
    s.meet_self(h);
    s.couple(h, near, held);
    near.advance(h);
  }
  s.solver.end_frame();
  s.profile.counts.substeps = parts;
  s.end_air(dt, near);
  s.read(dt, near, held);
  end_positions_ = s.positions;
}

// Whether cloth may meet cloth in this frame; what is held does not give way then.
void Cloth::State::begin_self(std::span<const HeldPoint> held) {
  self_near = false;
  if (design.self_contact.on) {
    StageTimer timer(profile.seconds.self);
    self_near = self.begin_frame(positions, velocities, dt);
  }
  // Corrections by the pass are no motion that a step of second order could go on from: it gains energy by
  // them.
  ClothSettings dial = solver.settings();
  if (const bool second = design.solver.second_order && !self_near; second != dial.second_order) {
    dial.second_order = second;
    solver.set_settings(dial);
  }
  if (!self_near) {
    return;
  }
  for (std::size_t v = 0; v < inverse_masses.size(); ++v) {
    inverse_masses[v] = 1.0 / wet.masses[v];
  }
  for (const HeldPoint& point : held) {
    if (std::isinf(point.max_force)) {
      inverse_masses[static_cast<std::size_t>(point.point)] = 0.0;
    }
  }
}

// Contact planes, with room for what the points may move in this frame.
void Cloth::State::gather(const NearColliders& near, double step, const Vec3& acceleration) {
  StageTimer timer(profile.seconds.gather);
  double fastest = 0;
  Vec3 low = positions.front(), high = low;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    fastest = std::max(fastest, velocities[v].squaredNorm());
    low = low.cwiseMin(positions[v]);
    high = high.cwiseMax(positions[v]);
  }
  double collider_speed = 0;
  for (int c = 0; c < near.colliders(); ++c) {
    collider_speed = std::max(collider_speed, near.velocity(c).norm());
  }
  const double size = (high - low).norm();
  ContactGatherer::Reach reach;
  reach.half_thickness = 0.5 * design.fabric.thickness;
  reach.motion = kSlack + step * (std::sqrt(fastest) + collider_speed + step * acceleration.norm());
  reach.air = airy() ? size : 0.0;
  gatherer.gather(near, {positions, friction_factor}, reach);
  coupling.begin(near, gatherer.contacts());
  profile.counts.planes = gatherer.planes();
}

// Which air is where; the film's pull on what touches.
bool Cloth::State::find_bubbles(const NearColliders& near) {
  if (!airy()) {
    profile.counts.air_skipped = true;
    solver.set_air({}, {}, {});
    bubbles.clear();
    return false;
  }
  StageTimer timer(profile.seconds.bubbles);
  Vec3 low = positions.front(), high = low;
  for (const Vec3& p : positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  air_origin = 0.5 * (low + high);
  for (std::size_t v = 0; v < positions.size(); ++v) {
    local_positions[v] = positions[v] - air_origin;
    local_feet[v] = gatherer.colliders()[v] >= 0 ? Vec3(gatherer.feet()[v] - air_origin) : local_positions[v];
  }
  const bool pressure = finder.find({local_positions, local_feet, gatherer.normals(), gatherer.gaps()});
  gatherer.set_adhesion(finder.adhesion());
  std::copy(gatherer.colliders().begin(), gatherer.colliders().end(), air_colliders.begin());
  choose_carrier(near);
  solver.set_air(finder.face_pockets(), finder.pockets(), finder.rims(), air_origin);
  volumes.resize(finder.pockets().size());
  gauges.assign(finder.pockets().size(), 0.0);
  return pressure;
}

// Handles as hands of the solver. Where several hold one point, a pin given last holds alone; limited ones
// pull together.
void Cloth::State::place_hands(double rest, NearColliders& near, std::span<HeldPoint> held) {
  const bool starts = rest == dt;
  hands.clear();
  hand_of.assign(held.size(), {});
  for (std::size_t i = 0; i < held.size(); ++i) {
    ClothHand hand = hand_for(held[i], rest, near);
    hand.starts = starts;
    const auto known = std::find_if(hands.begin(), hands.end(),
                                    [&](const ClothHand& other) { return other.point == hand.point; });
    if (known == hands.end()) {
      hand_of[i] = {static_cast<int>(hands.size()), 1.0};
      hands.push_back(hand);
      continue;
    }
    const int index = static_cast<int>(known - hands.begin());
    const bool pin = std::isinf(hand.max_force);
    if (std::isinf(known->max_force) && !pin) {
      continue;  // the pin holds
    }
    if (pin) {
      for (HandOf& other : hand_of) {
        other = other.hand == index ? HandOf{} : other;
      }
      *known = hand;
      hand_of[i] = {index, 1.0};
      continue;
    }
    const double force = known->max_force + hand.max_force, share = hand.max_force / force;
    for (HandOf& other : hand_of) {
      other.share *= other.hand == index ? 1.0 - share : 1.0;
    }
    known->target += share * (hand.target - known->target);
    known->velocity += share * (hand.velocity - known->velocity);
    known->max_force = force;
    hand_of[i] = {index, share};
  }
  solver.set_hands(hands);
}

// The way of one hand: from where its target was to where it is now, as fast as it has come; a limited one
// starts from its point.
ClothHand Cloth::State::hand_for(const HeldPoint& held, double rest, const NearColliders& near) const {
  const auto v = static_cast<std::size_t>(held.point);
  ClothHand hand;
  hand.point = held.point;
  hand.max_force = held.max_force;
  hand.target = held.target;
  hand.start = positions[v];
  hand.start_velocity = velocities[v];
  if (held.collider >= 0) {
    const Vec3 now = near.to_world(held.collider, held.target);
    hand.velocity = near.velocity_at(held.collider, now);
    hand.target = now + rest * hand.velocity;
    return hand;
  }
  for (const LastTarget& last : last_targets) {
    if (last.handle == held.handle) {
      hand.velocity = (held.target - last.target) / dt;
      if (std::isinf(held.max_force)) {
        hand.start = last.target;
        hand.start_velocity = last.velocity;
      }
    }
  }
  return hand;
}

// What moves within the frame: planes of colliders that curve or move, hands tied to them, air over them.
void Cloth::State::follow(NearColliders& near, double rest, std::span<HeldPoint> held) {
  StageTimer timer(profile.seconds.couple);
  if (near.pieces() > 0 && gatherer.outrun(positions)) {
    ContactGatherer::Reach reach = gatherer.reach();
    reach.air = 0.0;
    reach.motion *= 2.0;
    gatherer.gather(near, {positions, friction_factor}, reach);
    gatherer.set_adhesion(air_on ? finder.adhesion() : std::span<const double>());
    coupling.begin(near, gatherer.contacts());
    solver.set_contacts(gatherer.contacts());
    ++profile.counts.gathered_again;
  } else if (gatherer.follow(near, {positions, friction_factor})) {
    solver.set_contacts(gatherer.contacts());
  }
  if (std::any_of(held.begin(), held.end(), [](const HeldPoint& point) { return point.collider >= 0; })) {
    place_hands(rest, near, held);
  }
}

// Cloth on cloth, after each small step.
void Cloth::State::meet_self(double h) {
  profile.counts.self_skipped = !design.self_contact.on || !self_near;
  if (profile.counts.self_skipped) {
    return;
  }
  StageTimer timer(profile.seconds.self);
  const bool changed = self.correct({positions, velocities, inverse_masses, before, gatherer.contacts(), h},
                                    design.self_contact.friction);
  if (changed) {
    self_energy = std::max(self_energy, solver.mechanical_energy());
    solver.set_positions(positions);
    solver.set_velocities(velocities);
    calm_self(solver.mechanical_energy() - self_energy);
  }
  self_energy = solver.mechanical_energy();
}

// What corrections stretch must not come back as motion: what they leave beyond the energy (J) that the small
// step began with is taken out of the velocities relative to their mean, of held cloth out of all.
void Cloth::State::calm_self(double excess) {
  if (!(excess > 0.0)) {
    return;
  }
  Vec3 mean = Vec3::Zero();
  double mass = 0, relative = 0;
  for (std::size_t v = 0; v < velocities.size() && hands.empty(); ++v) {
    mean += wet.masses[v] * velocities[v];
    mass += wet.masses[v];
  }
  if (mass > 0.0) {
    mean /= mass;
  }
  for (std::size_t v = 0; v < velocities.size(); ++v) {
    relative += 0.5 * wet.masses[v] * (velocities[v] - mean).squaredNorm();
  }
  const double keep = relative > excess ? std::sqrt(1.0 - excess / relative) : 0.0;
  for (std::size_t v = 0; v < velocities.size(); ++v) {
    if (inverse_masses[v] > 0.0) {
      velocities[v] = mean + keep * (velocities[v] - mean);
    }
  }
  solver.set_velocities(velocities);
}

// Impulses of a small step on what they move, and of hands on what they are tied to.
void Cloth::State::couple(double h, NearColliders& near, std::span<HeldPoint> held) {
  StageTimer timer(profile.seconds.couple);
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (hand_of[i].hand < 0) {
      continue;
    }
    const Vec3 impulse = hand_of[i].share * solver.hand_impulse(hand_of[i].hand);
    held[i].impulse += impulse;
    if (held[i].collider >= 0) {
      near.push(held[i].collider, -impulse, positions[static_cast<std::size_t>(held[i].point)]);
    }
  }
  if (!coupling.any()) {
    return;
  }
  ColliderCoupling::Air air;
  if (air_on) {
    feel_air();
    air = {foot_forces,      world_feet,      air_colliders, finder.face_pockets(), finder.topology().faces,
           finder.pockets(), solver.pockets()};
  }
  if (coupling.balance(near, h, solver,
                       {positions, velocities, wet.masses, wet.springs, gatherer.contacts(), hands}, air)) {
    solver.set_positions(positions);
    solver.set_velocities(velocities);
  }
}

// Suction and pressure of the air on the colliders under it, as opposite forces at the feet.
void Cloth::State::feel_air() {
  const std::span<const PocketState> states = solver.pockets();
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    gauges[i] = states[i].gauge;
  }
  for (std::size_t v = 0; v < positions.size(); ++v) {
    local_positions[v] = positions[v] - air_origin - air_shift;
    world_feet[v] = local_feet[v] + air_origin + air_shift;
  }
  std::fill(foot_forces.begin(), foot_forces.end(), Vec3::Zero());
  finder.add_foot_forces({local_positions, local_feet, gatherer.normals(), gatherer.gaps()}, gauges,
                         foot_forces);
}

// Bubbles ride with what they lie on: their feet, and with them the origin of their volumes.
void Cloth::State::carry_air(const NearColliders& near) {
  if (!air_on || carrier < 0) {
    return;
  }
  const Vec3 shift = near.center(carrier) - carrier_start;
  if (shift != air_shift) {
    air_shift = shift;
    solver.set_air(finder.face_pockets(), finder.pockets(), finder.rims(), air_origin + air_shift);
  }
}

// The collider that most feet of bubbles stand on.
void Cloth::State::choose_carrier(const NearColliders& near) {
  carrier = -1;
  air_shift.setZero();
  std::vector<int>& votes = carrier_votes;
  votes.assign(static_cast<std::size_t>(near.colliders()), 0);
  const std::span<const int> pockets = finder.face_pockets();
  for (std::size_t f = 0; f < pockets.size(); ++f) {
    for (const int v : finder.topology().faces[f]) {
      const int collider = air_colliders[static_cast<std::size_t>(v)];
      if (pockets[f] >= 0 && collider >= 0) {
        const int count = ++votes[static_cast<std::size_t>(collider)];
        if (carrier < 0 || count > votes[static_cast<std::size_t>(carrier)]) {
          carrier = collider;
        }
      }
    }
  }
  if (carrier >= 0) {
    carrier_start = near.center(carrier);
  }
}

// Leak, limits and books of the air; its push on what does not move.
void Cloth::State::end_air(double step, NearColliders& near) {
  bubbles.clear();
  if (profile.counts.air_skipped) {
    return;
  }
  StageTimer timer(profile.seconds.bubbles);
  const std::span<const PocketState> states = solver.pockets();
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    volumes[i] = states[i].volume;
  }
  if (air_on) {
    feel_air();
    ColliderCoupling::push(near, step, air_colliders, foot_forces, world_feet);
  }
  measure_open_bubbles();
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    const AirPocket& pocket = finder.pockets()[i];
    const Bubble& bubble = finder.bubbles()[i];
    if (bubble.patch) {
      continue;
    }
    bubbles.push_back({bubble.faces, bubble.area, volumes[i],
                       pocket.open ? pocket.ambient : pocket.ambient + states[i].gauge, pocket.air,
                       pocket.open});
    profile.counts.pockets += !pocket.open;
  }
  finder.exchange(step, volumes);
}

// The solver has no use for their volumes, but the books have: what is under a sheet that falls flat leaves
// with its volume, or it would burst out again once the rim is sealed.
void Cloth::State::measure_open_bubbles() {
  bool placed = false;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    if (!finder.pockets()[i].open || finder.bubbles()[i].patch || finder.bubbles()[i].thin) {
      continue;
    }
    for (std::size_t v = 0; v < positions.size() && !placed; ++v) {
      local_positions[v] = positions[v] - air_origin - air_shift;
    }
    placed = true;
    volumes[i] = finder.volume(static_cast<int>(i), local_positions);
  }
}

// Contact forces as means over the step, and what is kept for the next one.
void Cloth::State::read(double step, NearColliders& near, std::span<HeldPoint> held) {
  const std::span<const PointContacts> contacts = gatherer.contacts();
  for (std::size_t v = 0; v < contact_forces.size(); ++v) {
    contact_forces[v].setZero();
    if (contacts[v].count == 0) {
      continue;
    }
    contact_forces[v] = solver.mean_contact_force(static_cast<int>(v));
    Vec3 parts[2];
    ColliderCoupling::split(contacts[v], contact_forces[v], parts);
    for (int k = 0; k < contacts[v].count; ++k) {
      const int collider = contacts[v].planes[k].collider;
      if (!near.collider(collider).movable && !parts[k].isZero(0)) {
        near.push(collider, -step * parts[k], positions[v]);
      }
    }
  }
  next_targets.clear();
  for (const HeldPoint& point : held) {
    if (point.collider < 0) {
      next_targets.push_back({point.handle, point.target, hand_for(point, 0.0, near).velocity});
    }
  }
  std::swap(last_targets, next_targets);
  profile.counts.queries = gatherer.queries();
  profile.counts.self_searches = self.counts.searches;
  profile.counts.self_patches = self.counts.patch_pairs;
  profile.counts.self_pairs = self.counts.pairs;
  profile.counts.self_contacts = self.counts.contacts;
  profile.counts.self_zones = self.counts.zones;
  profile.counts.self_dropped = self.counts.dropped;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
