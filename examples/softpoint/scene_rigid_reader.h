#pragma once

#include <optional>

#include "json_reader.h"
#include "scene.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// "position" and "orientation".
Placement read_placement(ObjectReader& item);
// "velocity" and "angular_velocity".
Motion read_motion(ObjectReader& item);
// "color".
std::optional<Rgb> read_color(ObjectReader& item);

// One of "rigid_bodies"; its name is "" if it has none.
RigidBodySpec read_rigid_body(ObjectReader& item);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
