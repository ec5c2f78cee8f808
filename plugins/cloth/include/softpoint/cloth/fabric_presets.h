#pragma once

#include <span>
#include <string_view>

#include "softpoint/cloth/air.h"
#include "softpoint/cloth/fabric.h"
#include "softpoint/cloth/wetness.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// How warp and weft cross: the three basic weaves.
enum class Weave { kPlain, kTwill, kSatin };
// What the yarns are made of.
enum class Fiber { kCotton, kPolyester, kSilk, kWool, kNylon, kLinen, kViscose };

// A fabric with what water does to it.
struct FabricPreset {
  Fabric fabric;
  Wetness wetness;
  double friction = 0.4;  // on a smooth solid, dry
};

// Typical numbers for a light dress fabric of this weave and fibre; their sources, and which of them are
// guesses, stand beside each number in fabric_presets.cpp. Cloths of one kind differ
// among each other by factors of two and more.
SOFTPOINT_API FabricPreset fabric_preset(Weave weave, Fiber fiber);
// `settings` with the pores and permeability of this fabric.
SOFTPOINT_API AirSettings air_of(const FabricPreset& preset, AirSettings settings = {});

// Lower-case names, as in scenes: "plain", "cotton"; all of them in the order of the enumeration.
SOFTPOINT_API std::span<const std::string_view> weave_names();
SOFTPOINT_API std::span<const std::string_view> fiber_names();

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
