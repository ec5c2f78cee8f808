#pragma once

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// Sums over all deformables and all rigid bodies that can move and are in the world.
struct MechanicalState {
  double kinetic = 0, elastic = 0,
         potential = 0;                  // J; the potential is that of the world's gravity, 0 at the origin
  Vec3 momentum = Vec3::Zero();          // kg m/s
  Vec3 angular_momentum = Vec3::Zero();  // kg m2/s, about the origin
  double momentum_scale = 0;             // kg m/s, sum of |m v| over the bodies

  double energy() const { return kinetic + elastic + potential; }
};

MechanicalState measure_state(Player& player);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
