// Cloth on cloth within a step.
#include <algorithm>
#include <cmath>

#include "cloth_state.h"
#include "softpoint/core/profile.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Whether cloth may meet cloth in this frame; what is held does not give way then.
void Cloth::State::begin_self(std::span<const HeldPoint> held) {
  self_near = false;
  if (design.self_contact.on) {
    StageTimer timer(profile.seconds.self);
    self_near = self.begin_frame(positions, velocities, dt);
  }
  prepare_self(held);
}

void Cloth::State::prepare_self(std::span<const HeldPoint> held) {
  // Corrections by the pass are no motion that a step of second order could go on from: it gains energy by
  // them.
  ClothSettings dial = solver.settings();
  if (const bool second = design.solver.second_order && !self_near; second != dial.second_order) {
    dial.second_order = second;
    solver.set_settings(dial);
  }
  solver.set_meets_itself(self_near);
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

// Cloth on cloth, after each small step. What hits something may begin to fold faster than anybody could see
// at the start of the frame.
void Cloth::State::meet_self(double h, std::span<const HeldPoint> held) {
  if (design.self_contact.on && !self_near && self.outrun(positions)) {
    self_near = true;
    prepare_self(held);
  }
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

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
