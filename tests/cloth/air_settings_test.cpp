// Every number of air and wetness, and what the presets hold.
#include <gtest/gtest.h>

#include <cmath>

#include "air_sheet.h"
#include "softpoint/cloth/fabric_presets.h"
#include "support/field_table.h"
#include "support/refusal.h"

namespace softpoint::cloth {
namespace {

Fields fields_of_air(AirSettings& settings) {
  auto& [bubbles, ambient, initial_volume, touch_gap, release_gap, lifetime, min_thickness, patch_suction,
         limit_suction, surface_tension, contact_angle, pore_diameter, vapour_pressure, leak, permeability,
         vent, viscosity, film_gap, bridge_gap, rim_width, wet, adhesion] = settings;
  static_assert(std::is_same_v<decltype(bubbles), Bubbles>);
  static_assert(std::is_same_v<decltype(patch_suction), bool> &&
                std::is_same_v<decltype(limit_suction), bool> && std::is_same_v<decltype(leak), bool> &&
                std::is_same_v<decltype(vent), bool> && std::is_same_v<decltype(adhesion), bool>);
  if (!initial_volume) initial_volume = 1e-4;
  return {{"ambient", ambient, 0, 1e9},
          {"initial_volume", *initial_volume, 0, 1e6},
          {"touch_gap", touch_gap, 0, 1},
          {"release_gap", release_gap, 0, 1},
          {"lifetime", lifetime, 1, 1000},
          {"min_thickness", min_thickness, 0, 1},
          {"surface_tension", surface_tension, 0, 10},
          {"contact_angle", contact_angle, 0, 1.5707963267948966},
          {"pore_diameter", pore_diameter, 1e-9, 1},
          {"vapour_pressure", vapour_pressure, 0, 1e9},
          {"permeability", permeability, 0, 1e3},
          {"viscosity", viscosity, 1e-9, 1},
          {"film_gap", film_gap, 1e-7, 0.1},
          {"bridge_gap", bridge_gap, 0, 1},
          {"rim_width", rim_width, 1e-6, 1},
          {"wet", wet, 0, 1}};
}

// A tent that rises and falls.
bool breathes(AirSheet& sheet) {
  for (int frame = 0; frame < 8; ++frame) {
    sheet.lift([=](double x, double y) { return bump(x, y, 0.01 * (1 + frame % 4), 0.1); });
    sheet.find();
    sheet.exchange(1.0 / 60);
    for (int i = 0; i < sheet.pockets(); ++i) {
      if (!std::isfinite(sheet.air(i)) || sheet.air(i) < 0) return false;
    }
    for (const double force : sheet.finder.adhesion()) {
      if (!std::isfinite(force)) return false;
    }
  }
  const double scale = std::max({sheet.finder.initial_air(), std::abs(sheet.finder.vented()), 1e-300});
  return std::abs(sheet.finder.audit()) <= 1e-9 * scale;
}

TEST(EveryField, OfAirSettingsAtConstruction) {
  AirSettings valid;
  valid.release_gap = 1;  // so that any touch_gap goes with it
  expect_every_field<AirSettings>(
      valid, fields_of_air,
      [](const AirSettings& settings) {
        AirSheet sheet(settings, 12, 0.3, 0.7);
        return breathes(sheet);
      },
      [] { return std::string(); }, Range::necessary);
  AirSettings settings;
  settings.release_gap = 1e-4;
  expect_refusal([&] { check(settings); }, {"air.release_gap", to_text(1e-4), "permitted", to_text(3e-4)});
  settings = {};
  settings.bubbles = static_cast<Bubbles>(7);
  expect_refusal([&] { check(settings); }, {"air.bubbles", "7", "permitted", "off, one, found"});
}

TEST(EveryField, OfAirSettingsOfACloth) {
  AirSheet sheet({}, 12, 0.3, 0.7);
  AirSettings valid;
  valid.release_gap = 1;
  expect_every_field<AirSettings>(
      valid, fields_of_air,
      [&](const AirSettings& settings) {
        sheet.finder.set_settings(settings);
        return breathes(sheet);
      },
      [&] {
        return to_text(sheet.finder.settings().pore_diameter) + to_text(sheet.finder.settings().wet) +
               to_text(sheet.finder.air()) + to_text(sheet.finder.vented());
      },
      Range::necessary);
}

Fields fields_of_wetness(Wetness& wetness) {
  auto& [capacity, friction, warp, weft, shear, bending, pores, permeability] = wetness;
  return {{"capacity", capacity, 0, 100},       {"friction_factor", friction, 0.01, 100},
          {"warp_factor", warp, 0.001, 1000},   {"weft_factor", weft, 0.001, 1000},
          {"shear_factor", shear, 0.001, 1000}, {"bending_factor", bending, 0.001, 1000},
          {"pore_diameter", pores, 1e-9, 1},    {"permeability", permeability, 0, 1e3}};
}

TEST(EveryField, OfWetness) {
  const ClothPattern dry = square_pattern(5, 5, 0.1, 0.1, Fabric{});
  ClothPattern wet = dry;
  const std::vector<double> full(dry.points.size(), 1.0);
  const auto sum = [&] {
    double masses = 0, stiffness = 0;
    for (const double mass : wet.masses) masses += mass;
    for (const Spring& spring : wet.springs) stiffness += spring.stiffness;
    return to_text(masses) + " " + to_text(stiffness);
  };
  expect_every_field<Wetness>(
      {}, fields_of_wetness,
      [&](const Wetness& wetness) {
        wet_pattern(dry, full, wetness, wet);
        for (const double mass : wet.masses) {
          if (!(mass > 0 && mass < 1e3)) return false;
        }
        return true;
      },
      sum);
}

TEST(Wetness, ChangesMassAndStiffnessWhereItIs) {
  Fabric fabric;
  fabric.bending_stiffness = 1e-5;
  const ClothPattern dry = square_pattern(11, 11, 0.1, 0.1, fabric);
  ClothPattern wet = dry;
  Wetness wetness;
  wetness.capacity = 0.8;
  wetness.warp_factor = 1.5;
  wetness.weft_factor = 0.5;
  wetness.shear_factor = 2;
  wetness.bending_factor = 3;
  std::vector<double> painted(dry.points.size(), 0.0);
  for (std::size_t i = 0; i < painted.size(); ++i) painted[i] = dry.points[i].x() > 0.001 ? 1.0 : 0.0;
  wet_pattern(dry, painted, wetness, wet);
  for (std::size_t i = 0; i < painted.size(); ++i) {
    EXPECT_DOUBLE_EQ(wet.masses[i], dry.masses[i] * (painted[i] > 0 ? 1.8 : 1.0));
  }
  for (std::size_t i = 0; i < dry.springs.size(); ++i) {
    const Spring& spring = dry.springs[i];
    const double mean = (painted[spring.a] + painted[spring.b]) / 2;
    const double factor = spring.kind == SpringKind::kWarp   ? 1.5
                          : spring.kind == SpringKind::kWeft ? 0.5
                                                             : 2.0;
    EXPECT_DOUBLE_EQ(wet.springs[i].stiffness, spring.stiffness * (1 + (factor - 1) * mean));
  }
  ASSERT_FALSE(dry.bends.empty());
  bool stiffer = false;
  for (std::size_t i = 0; i < dry.bends.size(); ++i) {
    EXPECT_GE(wet.bends[i].stiffness, dry.bends[i].stiffness);
    stiffer = stiffer || wet.bends[i].stiffness == 3 * dry.bends[i].stiffness;
  }
  EXPECT_TRUE(stiffer);
  EXPECT_DOUBLE_EQ(friction_factor(wetness, 0), 1);
  EXPECT_DOUBLE_EQ(friction_factor(wetness, 1), wetness.friction_factor);
  // Dry again: as it was.
  wet_pattern(dry, std::vector<double>(painted.size(), 0.0), wetness, wet);
  for (std::size_t i = 0; i < painted.size(); ++i) EXPECT_EQ(wet.masses[i], dry.masses[i]);
  for (std::size_t i = 0; i < dry.springs.size(); ++i) {
    EXPECT_EQ(wet.springs[i].stiffness, dry.springs[i].stiffness);
  }
  expect_refusal([&] { wet_pattern(dry, std::vector<double>(3, 0.0), wetness, wet); },
                 {"saturation", "3", "121"});
  painted[7] = -0.1;
  expect_refusal([&] { wet_pattern(dry, painted, wetness, wet); }, {"saturation", "-0.1", "0", "1"});
}

TEST(Presets, AreSoundForEachWeaveAndFiber) {
  for (std::size_t w = 0; w < weave_names().size(); ++w) {
    for (std::size_t f = 0; f < fiber_names().size(); ++f) {
      SCOPED_TRACE(std::string(weave_names()[w]) + " " + std::string(fiber_names()[f]));
      const FabricPreset preset = fabric_preset(static_cast<Weave>(w), static_cast<Fiber>(f));
      check(preset.fabric);
      check(preset.wetness);
      check(air_of(preset));
      EXPECT_EQ(air_of(preset).pore_diameter, preset.wetness.pore_diameter);
      // Dress fabrics by Kawabata's method.
      EXPECT_GE(preset.fabric.warp_stiffness, 2e3);
      EXPECT_LE(preset.fabric.warp_stiffness, 25e3);
      EXPECT_LE(preset.fabric.weft_stiffness, preset.fabric.warp_stiffness);
      EXPECT_GE(preset.fabric.shear_stiffness, 17);
      EXPECT_LE(preset.fabric.shear_stiffness, 101);
      EXPECT_GE(preset.fabric.bending_stiffness, 10e-6);
      EXPECT_LE(preset.fabric.bending_stiffness, 66e-6);
      EXPECT_GE(preset.wetness.friction_factor, 2);
      EXPECT_LE(preset.wetness.friction_factor, 5);
      // 20 to 200 mm/s at 100 Pa.
      EXPECT_GE(preset.wetness.permeability, 2e-4);
      EXPECT_LE(preset.wetness.permeability, 2e-3);
    }
  }
  EXPECT_EQ(weave_names().size(), 3u);
  expect_refusal([] { fabric_preset(static_cast<Weave>(3), Fiber::kSilk); }, {"weave", "3"});
  expect_refusal([] { fabric_preset(Weave::kPlain, static_cast<Fiber>(-1)); }, {"fiber", "-1"});
}

TEST(Presets, KeepTheOrderOfWeavesAndTheWaysOfFibers) {
  const FabricPreset plain = fabric_preset(Weave::kPlain, Fiber::kCotton);
  const FabricPreset twill = fabric_preset(Weave::kTwill, Fiber::kCotton);
  const FabricPreset satin = fabric_preset(Weave::kSatin, Fiber::kCotton);
  EXPECT_GT(plain.fabric.weft_stiffness, twill.fabric.weft_stiffness);
  EXPECT_GT(twill.fabric.weft_stiffness, satin.fabric.weft_stiffness);
  EXPECT_GT(plain.fabric.bending_stiffness, satin.fabric.bending_stiffness);
  EXPECT_LT(satin.friction, plain.friction);
  EXPECT_LT(satin.wetness.capacity, plain.wetness.capacity);
  EXPECT_GT(plain.wetness.warp_factor, 1) << "cotton swells and jams";
  EXPECT_LT(fabric_preset(Weave::kPlain, Fiber::kWool).wetness.warp_factor, 1) << "wool softens";
  EXPECT_EQ(fabric_preset(Weave::kPlain, Fiber::kPolyester).wetness.warp_factor, 1);
}

}  // namespace
}  // namespace softpoint::cloth
