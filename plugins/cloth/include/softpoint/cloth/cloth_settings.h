#pragma once

#include <cstdint>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Numbers of the sweeps. The air's bookkeeping is double in both.
enum class Precision : std::int8_t { kSingle, kDouble };

// The dial between speed and accuracy. The defaults are those of kDefault.
struct ClothSettings {
  double max_substep = 1.0 / 1200;  // longest small step, s; kMinSubstep to 1
  double max_move =
      0.25;  // hands and colliders move at most this part of the spacing a small step; 0: any distance
  int max_substeps =
      400;         // a step of the world is never cut into more, whatever the two above say; 1 to 100000
  int sweeps = 2;  // Gauss-Seidel sweeps a small step; 1 to 1000
  int coarse_every = 1;   // small steps from one coarse correction to the next; 0: none
  int coarse_points = 7;  // points along the side of a coarse patch; 2 to 64
  // Sheets of a grid without bending take each small step by explicit ones, this long at most (s), as far as
  // they are stable; 0: never. 0 to 1
  double march_step = 1.0 / 14400;
  bool second_order = true;  // in time where nothing touches: free swing keeps its energy
  bool guard = true;         // energy may not rise by itself
  Precision precision = Precision::kSingle;
};

// Shortest step of the sweeps, s.
inline constexpr double kMinSubstep = 1e-7;

// Named settings of the dial.
enum class Dial { kFast, kDefault, kExact };
SOFTPOINT_API ClothSettings settings_of(Dial dial);

// Throws Error naming the field, as "<name>.max_substep" and so on.
SOFTPOINT_API void check(const ClothSettings& settings, std::string_view name = "settings");

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
