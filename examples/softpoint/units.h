#pragma once

#include <span>
#include <string>
#include <string_view>

#include "softpoint/core/config.h"

// Physical quantities in documents: a plain number counts in the SI unit, a text "<number> <unit>"
// in the unit it names.
namespace softpoint::inline SOFTPOINT_ABI::scene {

enum class Quantity {
  kNumber,  // without dimension
  kLength,
  kArea,
  kVolume,
  kMass,
  kTime,
  kFrequency,
  kAngle,
  kPressure,
  kDensity,
  kAreaDensity,
  kVelocity,
  kAngularVelocity,
  kAcceleration,
  kForce,
  kTorque,
  kImpulse,
  kEnergy,
  kSpringConstant,
  kDamping,
};

// value in SI = number * multiply / divide: 7 cm is 7 / 100 m, the double nearest to 0.07.
struct Unit {
  std::string_view name;
  double multiply;
  double divide;
};

// "length", "angular velocity", ...
std::string_view quantity_name(Quantity quantity);
// The first is the SI unit; empty for kNumber.
std::span<const Unit> quantity_units(Quantity quantity);
// "m", "kg/m3", ...; "" for kNumber.
std::string_view si_unit(Quantity quantity);

struct ParsedQuantity {
  double value = 0;     // SI
  std::string problem;  // empty if the text is a quantity of the kind asked for
};

// "12 cm", "1e5 Pa", "-3.5deg". Does not depend on the locale.
ParsedQuantity parse_quantity(Quantity quantity, std::string_view text);

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
