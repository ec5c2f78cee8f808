#include "units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace softpoint::scene {
namespace {

double si(Quantity quantity, std::string_view text) {
  const ParsedQuantity parsed = parse_quantity(quantity, text);
  EXPECT_EQ(parsed.problem, "") << text;
  return parsed.value;
}

TEST(Units, ConvertToSi) {
  EXPECT_EQ(si(Quantity::kLength, "7 cm"), 0.07);
  EXPECT_EQ(si(Quantity::kLength, "3mm"), 0.003);
  EXPECT_EQ(si(Quantity::kLength, "  -1.5 km "), -1500.0);
  EXPECT_EQ(si(Quantity::kMass, "250 g"), 0.25);
  EXPECT_EQ(si(Quantity::kMass, "2 t"), 2000.0);
  EXPECT_EQ(si(Quantity::kTime, "16 ms"), 0.016);
  EXPECT_EQ(si(Quantity::kTime, "2 min"), 120.0);
  EXPECT_DOUBLE_EQ(si(Quantity::kAngle, "180 deg"), M_PI);
  EXPECT_EQ(si(Quantity::kPressure, "1e-2 MPa"), 1e4);
  EXPECT_EQ(si(Quantity::kPressure, "70 GPa"), 7e10);
  EXPECT_EQ(si(Quantity::kDensity, "7.8 g/cm3"), 7800.0);
  EXPECT_EQ(si(Quantity::kVelocity, "36 km/h"), 10.0);
  EXPECT_EQ(si(Quantity::kAcceleration, "9.81 m/s2"), 9.81);
  EXPECT_EQ(si(Quantity::kAcceleration, "9.81 m/s^2"), 9.81);
  EXPECT_EQ(si(Quantity::kForce, "3 kN"), 3000.0);
  EXPECT_EQ(si(Quantity::kTorque, "2 N m"), 2.0);
  EXPECT_DOUBLE_EQ(si(Quantity::kAngularVelocity, "60 rpm"), 2.0 * M_PI);
}

TEST(Units, EveryUnitIsKnownToItsOwnQuantityOnly) {
  for (int k = 0; k <= static_cast<int>(Quantity::kDamping); ++k) {
    const auto quantity = static_cast<Quantity>(k);
    for (const Unit& unit : quantity_units(quantity)) {
      for (int other = 0; other <= static_cast<int>(Quantity::kDamping); ++other) {
        const std::string text = "2 " + std::string(unit.name);
        EXPECT_EQ(parse_quantity(static_cast<Quantity>(other), text).problem.empty(), other == k)
            << text << " as " << quantity_name(static_cast<Quantity>(other));
      }
    }
  }
}

TEST(Units, TheFirstUnitIsTheSiUnit) {
  for (int k = 1; k <= static_cast<int>(Quantity::kDamping); ++k) {
    const auto quantity = static_cast<Quantity>(k);
    EXPECT_EQ(si(quantity, "3 " + std::string(si_unit(quantity))), 3.0);
  }
  EXPECT_EQ(si_unit(Quantity::kNumber), "");
}

TEST(Units, RefusalsSayWhatIsPermitted) {
  struct Case {
    Quantity quantity;
    const char* text;
    std::vector<std::string> fragments;
  };
  const std::vector<Case> cases = {
      {Quantity::kMass, "3 cm", {"cm measures length", "permitted is a mass", "kg, g, t"}},
      {Quantity::kLength, "3 furlong", {"unknown unit furlong", "m, cm, mm, km"}},
      {Quantity::kLength, "3", {"without a unit"}},
      {Quantity::kLength, "cm", {"no number"}},
      {Quantity::kLength, "", {"no number"}},
      {Quantity::kLength, "1,5 m", {"unknown unit ,5 m"}},
      {Quantity::kLength, "nan m", {"no number"}},
      {Quantity::kLength, "inf m", {"no number"}},
      {Quantity::kLength, "1e999 m", {"no number"}},
      {Quantity::kLength, "1e308 km", {"too large"}},
      {Quantity::kNumber, "3 m", {"m measures length", "plain number"}},
      {Quantity::kNumber, "3", {"plain number"}},
  };
  for (const Case& c : cases) {
    const ParsedQuantity parsed = parse_quantity(c.quantity, c.text);
    for (const std::string& fragment : c.fragments) {
      EXPECT_NE(parsed.problem.find(fragment), std::string::npos) << c.text << ": " << parsed.problem;
    }
  }
}

}  // namespace
}  // namespace softpoint::scene
