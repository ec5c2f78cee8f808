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
  const long long marched = s.solver.profile().marched, refused = s.solver.profile().march_refused;
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
    s.meet_self(h, held);
    s.couple(h, near, held);
    near.advance(h);
  }
  s.solver.end_frame();
  s.profile.counts.substeps = parts;
  s.profile.counts.marched = static_cast<int>(s.solver.profile().marched - marched);
  s.profile.counts.march_refused = static_cast<int>(s.solver.profile().march_refused - refused);
  s.end_air(dt, near);
  s.read(dt, near, held);
  end_positions_ = s.positions;
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

// Handles as hands of the solver. Where several hold one point, a pin given last holds alone; limited ones
// pull together.
void Cloth::State::place_hands(double rest, NearColliders& near, std::span<HeldPoint> held) {
  const bool starts = rest == dt;
  hands.clear();
  hand_of.assign(held.size(), {});
  ties.assign(static_cast<std::size_t>(near.colliders()), 0);
  for (const HeldPoint& point : held) {
    if (point.collider >= 0) ++ties[static_cast<std::size_t>(point.collider)];
  }
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
    if (near.collider(held.collider).movable) {
      hand.start = now;
      hand.mass = tied_mass(near, held.collider, now);
    }
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

// What a collider weighs for a pull at `point`, kg, shared by the points tied to it: the least in any
// direction. A tie that the body follows only after each small step would swing up what is not far heavier
// than the springs feel: h^2 k.
double Cloth::State::tied_mass(const NearColliders& near, int collider, const Vec3& point) const {
  Eigen::Matrix<double, 6, 6> block;
  near.mobility(collider, block.data());
  const Vec3 arm = point - near.center(collider);
  Eigen::Matrix<double, 3, 6> carried;       // velocity at the point per (velocity, spin)
  carried << 1, 0, 0, 0, arm.z(), -arm.y(),  //
      0, 1, 0, -arm.z(), 0, arm.x(),         //
      0, 0, 1, arm.y(), -arm.x(), 0;
  const Mat3 gives = carried * block * carried.transpose();
  const double most = gives.norm();
  return most > 0.0 ? 1.0 / (most * std::max(1, ties[static_cast<std::size_t>(collider)])) : 0.0;
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
