#pragma once

#include <nlohmann/json_fwd.hpp>

#include "player.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {

// What making the figures' animations has come to: a list of objects, one a figure.
nlohmann::ordered_json figures_json(const Player& player);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
