#pragma once

#include <string>
#include <string_view>

#include "json_reader.h"
#include "softpoint/core/limits.h"

// Permitted ranges of documents where no law of its own sets one: far beyond any use, near enough that what
// is computed from them stays finite in single precision.
namespace softpoint::inline SOFTPOINT_ABI::scene {

inline constexpr double kMinLength = 1e-6, kMaxLength = 1e4;  // m, of shapes and meshes
inline constexpr double kMaxPlace = 5e5;                      // m from the origin along an axis
inline constexpr double kMaxTime = 1e6;                       // s
inline constexpr double kMaxAngle = 1e6;                      // rad
inline constexpr double kMaxDirection = 1e6;                  // of a component, where any length will do
inline constexpr double kMaxMass = 1e12, kMinMass = 1e-9;     // kg, of rigid bodies that move
inline constexpr double kMaxForce = 1e12;                     // N
inline constexpr double kMaxScale = 1e6;                      // of a file's lengths; its inverse is the least

inline double length(ObjectReader& reader, std::string_view key, const std::string& doc = "") {
  return reader.number(key,
                       {.quantity = Quantity::kLength, .low = kMinLength, .high = kMaxLength, .doc = doc});
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
