// The air of a step: which bubbles there are, what they push, what they ride on, where their air goes.
#include <algorithm>
#include <cmath>

#include "cloth_state.h"
#include "softpoint/core/near_colliders.h"
#include "softpoint/core/profile.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

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

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
