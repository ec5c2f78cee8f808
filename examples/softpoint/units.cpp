#include "units.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <system_error>

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using std::numbers::pi;

constexpr std::array kLengths{Unit{"m", 1, 1}, Unit{"cm", 1, 100}, Unit{"mm", 1, 1000}, Unit{"km", 1000, 1}};
constexpr std::array kAreas{Unit{"m2", 1, 1}, Unit{"cm2", 1, 1e4}, Unit{"mm2", 1, 1e6}};
constexpr std::array kVolumes{Unit{"m3", 1, 1}, Unit{"l", 1, 1e3}, Unit{"cm3", 1, 1e6}, Unit{"ml", 1, 1e6}};
constexpr std::array kMasses{Unit{"kg", 1, 1}, Unit{"g", 1, 1000}, Unit{"t", 1000, 1}};
constexpr std::array kTimes{Unit{"s", 1, 1}, Unit{"ms", 1, 1000}, Unit{"min", 60, 1}};
constexpr std::array kFrequencies{Unit{"Hz", 1, 1}, Unit{"kHz", 1000, 1}};
constexpr std::array kAngles{Unit{"rad", 1, 1}, Unit{"deg", pi, 180}};
constexpr std::array kPressures{Unit{"Pa", 1, 1}, Unit{"kPa", 1e3, 1}, Unit{"MPa", 1e6, 1},
                                Unit{"GPa", 1e9, 1}};
constexpr std::array kDensities{Unit{"kg/m3", 1, 1}, Unit{"g/cm3", 1000, 1}};
constexpr std::array kAreaDensities{Unit{"kg/m2", 1, 1}, Unit{"g/m2", 1, 1000}};
constexpr std::array kVelocities{Unit{"m/s", 1, 1}, Unit{"cm/s", 1, 100}, Unit{"mm/s", 1, 1000},
                                 Unit{"km/h", 1, 3.6}};
constexpr std::array kAngularVelocities{Unit{"rad/s", 1, 1}, Unit{"deg/s", pi, 180}, Unit{"rpm", pi, 30}};
constexpr std::array kAccelerations{Unit{"m/s2", 1, 1}, Unit{"cm/s2", 1, 100}};
constexpr std::array kForces{Unit{"N", 1, 1}, Unit{"mN", 1, 1000}, Unit{"kN", 1000, 1}};
constexpr std::array kTorques{Unit{"N m", 1, 1}, Unit{"kN m", 1000, 1}};
constexpr std::array kImpulses{Unit{"N s", 1, 1}};
constexpr std::array kEnergies{Unit{"J", 1, 1}, Unit{"mJ", 1, 1000}, Unit{"kJ", 1000, 1}};
constexpr std::array kSpringConstants{Unit{"N/m", 1, 1}, Unit{"N/mm", 1000, 1}, Unit{"kN/m", 1000, 1}};
constexpr std::array kDampings{Unit{"N s/m", 1, 1}};

struct Kind {
  Quantity quantity;
  std::string_view name;
  std::span<const Unit> units;
};

// In the order of the enumeration.
constexpr std::array kKinds{
    Kind{Quantity::kNumber, "number", {}},
    Kind{Quantity::kLength, "length", kLengths},
    Kind{Quantity::kArea, "area", kAreas},
    Kind{Quantity::kVolume, "volume", kVolumes},
    Kind{Quantity::kMass, "mass", kMasses},
    Kind{Quantity::kTime, "time", kTimes},
    Kind{Quantity::kFrequency, "frequency", kFrequencies},
    Kind{Quantity::kAngle, "angle", kAngles},
    Kind{Quantity::kPressure, "pressure", kPressures},
    Kind{Quantity::kDensity, "density", kDensities},
    Kind{Quantity::kAreaDensity, "mass per area", kAreaDensities},
    Kind{Quantity::kVelocity, "velocity", kVelocities},
    Kind{Quantity::kAngularVelocity, "angular velocity", kAngularVelocities},
    Kind{Quantity::kAcceleration, "acceleration", kAccelerations},
    Kind{Quantity::kForce, "force", kForces},
    Kind{Quantity::kTorque, "torque", kTorques},
    Kind{Quantity::kImpulse, "impulse", kImpulses},
    Kind{Quantity::kEnergy, "energy", kEnergies},
    Kind{Quantity::kSpringConstant, "spring constant", kSpringConstants},
    Kind{Quantity::kDamping, "damping", kDampings},
};

constexpr bool in_order() {
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    if (kKinds[k].quantity != static_cast<Quantity>(k)) {
      return false;
    }
  }
  return true;
}
static_assert(in_order());

const Kind& kind(Quantity quantity) { return kKinds[static_cast<std::size_t>(quantity)]; }

// Both spellings of a power are taken: m/s2 and m/s^2.
std::string without_carets(std::string_view text) {
  std::string result(text);
  std::erase(result, '^');
  return result;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::string unit_list(const Kind& wanted) {
  std::string list;
  for (const Unit& unit : wanted.units) {
    list += (list.empty() ? "" : ", ");
    list += unit.name;
  }
  return list;
}

std::string permitted(const Kind& wanted) {
  if (wanted.units.empty()) {
    return "permitted is a plain number";
  }
  return fmt::format(
      "permitted is a {}: a number in {}, or a text \"<number> <unit>\" with one of the units {}",
      wanted.name, wanted.units.front().name, unit_list(wanted));
}

}  // namespace

std::string_view quantity_name(Quantity quantity) { return kind(quantity).name; }

std::span<const Unit> quantity_units(Quantity quantity) { return kind(quantity).units; }

std::string_view si_unit(Quantity quantity) {
  const auto& units = kind(quantity).units;
  return units.empty() ? std::string_view() : units.front().name;
}

ParsedQuantity parse_quantity(Quantity quantity, std::string_view text) {
  const Kind& wanted = kind(quantity);
  const std::string_view body = trimmed(text);
  ParsedQuantity result;
  const auto [end, error] = std::from_chars(body.data(), body.data() + body.size(), result.value);
  if (error != std::errc() || !std::isfinite(result.value)) {
    result.problem = "no number at its head; " + permitted(wanted);
    return result;
  }
  const std::string name = without_carets(trimmed(body.substr(static_cast<std::size_t>(end - body.data()))));
  for (const Unit& unit : wanted.units) {
    if (unit.name == name) {
      result.value = result.value * unit.multiply / unit.divide;
      if (!std::isfinite(result.value)) {
        result.problem = "too large; " + permitted(wanted);
      }
      return result;
    }
  }
  if (name.empty()) {
    result.problem = "a text without a unit; " + permitted(wanted);
    return result;
  }
  for (const Kind& other : kKinds) {
    for (const Unit& unit : other.units) {
      if (unit.name == name) {
        result.problem = fmt::format("{} measures {}; {}", name, other.name, permitted(wanted));
        return result;
      }
    }
  }
  result.problem = fmt::format("unknown unit {}; {}", name, permitted(wanted));
  return result;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
