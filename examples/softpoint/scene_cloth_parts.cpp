#include "scene_cloth_parts.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>

#include "scene_limits.h"
#include "softpoint/cloth/fabric_presets.h"
#include "softpoint/core/error.h"

namespace softpoint::inline SOFTPOINT_ABI::scene {
namespace {

using cloth::AirSettings;

std::vector<std::string> names_of(std::span<const std::string_view> names) {
  return {names.begin(), names.end()};
}

// One of the numbers of a preset, or another.
struct Numbers {
  ObjectReader& reader;

  void operator()(std::string_view key, double& value, Quantity quantity, double low, double high,
                  const std::string& doc) {
    value = reader.optional_number(key, {.quantity = quantity, .low = low, .high = high, .doc = doc})
                .value_or(value);
  }
};

void read_fabric(ObjectReader& item, cloth::FabricPreset& preset) {
  item.optional_object(
      "fabric", "a preset by weave and fiber, plain polyester if absent; each number may be another",
      [&](ObjectReader& reader) {
        const int weave = reader.choice("weave", names_of(cloth::weave_names()), {.fallback = "plain"});
        const int fiber = reader.choice("fiber", names_of(cloth::fiber_names()), {.fallback = "polyester"});
        preset = cloth::fabric_preset(static_cast<cloth::Weave>(weave), static_cast<cloth::Fiber>(fiber));
        cloth::Fabric& fabric = preset.fabric;
        Numbers number{reader};
        number("area_density", fabric.area_density, Quantity::kAreaDensity, cloth::kMinAreaDensity,
               cloth::kMaxAreaDensity, "dry");
        number("warp_stiffness", fabric.warp_stiffness, Quantity::kSpringConstant, 0,
               cloth::kMaxSpringStiffness, "of springs along x of a sheet");
        number("weft_stiffness", fabric.weft_stiffness, Quantity::kSpringConstant, 0,
               cloth::kMaxSpringStiffness, "along z; surfaces from a mesh want it to be that of the warp");
        number("shear_stiffness", fabric.shear_stiffness, Quantity::kSpringConstant, 0,
               cloth::kMaxSpringStiffness, "of diagonals");
        number("bending_stiffness", fabric.bending_stiffness, Quantity::kNumber, 0,
               cloth::kMaxBendingStiffness, "N m, a width");
        number("compression_ratio", fabric.compression_ratio, Quantity::kNumber, 0, 1,
               "stiffness of shortened springs over that of stretched ones; 1 in the thesis");
        number("damping_time", fabric.damping_time, Quantity::kTime, 0, cloth::kMaxDampingTime,
               "a spring's damper is this times its stiffness");
        number("drag_rate", fabric.drag_rate, Quantity::kFrequency, 0, cloth::kMaxDragRate,
               "share of speed lost to the air in a second");
        number("thickness", fabric.thickness, Quantity::kLength, 0, 0.1, "");
      });
}

void read_wetness(ObjectReader& item, cloth::Wetness& wetness, double& saturation,
                  std::vector<WetPatch>& paint) {
  item.optional_object(
      "wetness", "dry if absent; what water does is by the fabric's preset, or as said",
      [&](ObjectReader& reader) {
        saturation = reader.number(
            "saturation", {.low = 0.0, .high = 1.0, .fallback = 1.0, .doc = "0 dry to 1 soaked, everywhere"});
        Numbers number{reader};
        number("capacity", wetness.capacity, Quantity::kNumber, 0, 100, "mass of water over dry mass");
        number("friction_factor", wetness.friction_factor, Quantity::kNumber, 0.01, 100,
               "friction wet over dry");
        number("warp_factor", wetness.warp_factor, Quantity::kNumber, 0.001, 1000, "stiffness wet over dry");
        number("weft_factor", wetness.weft_factor, Quantity::kNumber, 0.001, 1000, "");
        number("shear_factor", wetness.shear_factor, Quantity::kNumber, 0.001, 1000, "");
        number("bending_factor", wetness.bending_factor, Quantity::kNumber, 0.001, 1000, "");
        reader.list("paint", {.optional = true, .doc = "parts with another saturation; the last counts"},
                    [&](ObjectReader& patch, int) {
                      WetPatch spot;
                      spot.at = patch.vec3("at", {.quantity = Quantity::kLength,
                                                  .low = -kMaxLength,
                                                  .high = kMaxLength,
                                                  .doc = "on the pattern, from its middle"});
                      spot.radius = length(patch, "radius");
                      spot.saturation = patch.number("saturation", {.low = 0.0, .high = 1.0});
                      paint.push_back(spot);
                    });
      });
}

void read_air(ObjectReader& item, AirSettings& air) {
  const auto read = [&](ObjectReader& reader) {
    air.bubbles = reader.choice<cloth::Bubbles>(
        "bubbles",
        {{"found", cloth::Bubbles::kFound}, {"one", cloth::Bubbles::kOne}, {"off", cloth::Bubbles::kOff}},
        {.fallback = "found", .doc = "one: the thesis' bubble under all of the cloth; off: none"});
    Numbers number{reader};
    number("ambient", air.ambient, Quantity::kPressure, 0, 1e9, "of the atmosphere; 101325 Pa");
    air.initial_volume = reader.optional_number(
        "initial_volume",
        {.quantity = Quantity::kVolume,
         .low = 0.0,
         .high = 1e6,
         .doc = "of the air under it at the start, at ambient pressure; absent: what is there"});
    number("touch_gap", air.touch_gap, Quantity::kLength, 0, 1, "nearer points touch; 0.3 mm");
    number("release_gap", air.release_gap, Quantity::kLength, 0, 1, "until they are farther than this; 1 mm");
    air.lifetime = reader.integer(
        "lifetime", {.low = 1, .high = 1000, .fallback = air.lifetime, .doc = "frames a touch has to last"});
    number("min_thickness", air.min_thickness, Quantity::kLength, 0, 1, "thinner bubbles rest on the patch");
    air.limit_suction = reader.boolean(
        "limit_suction",
        {.fallback = air.limit_suction, .doc = "by the weave's bubble point and vapour pressure"});
    number("surface_tension", air.surface_tension, Quantity::kNumber, 0, 10, "N/m; 0.0728");
    number("contact_angle", air.contact_angle, Quantity::kAngle, 0, std::numbers::pi / 2, "of water; 0");
    number("pore_diameter", air.pore_diameter, Quantity::kLength, 1e-9, 1, "by the fabric's preset");
    number("vapour_pressure", air.vapour_pressure, Quantity::kPressure, 0, 1e9, "2340 Pa");
    air.leak = reader.boolean("leak", {.fallback = air.leak, .doc = "through the weave"});
    number("permeability", air.permeability, Quantity::kNumber, 0, 1e3,
           "m/(s Pa), dry; by the fabric's preset");
    air.vent = reader.boolean(
        "vent", {.fallback = air.vent, .doc = "under the rim; off: it is sealed whatever its gap"});
    number("viscosity", air.viscosity, Quantity::kNumber, 1e-9, 1, "Pa s; 18e-6");
    number("film_gap", air.film_gap, Quantity::kLength, 1e-7, 0.1, "of the film under the rim; 0.2 mm");
    number("bridge_gap", air.bridge_gap, Quantity::kLength, 0, 1, "no film spans more; 2.7 mm");
    number("rim_width", air.rim_width, Quantity::kLength, 1e-6, 1, "along the flow; 5 mm");
    number("wet", air.wet, Quantity::kNumber, 0, 1, "saturation from which films seal; 0.3");
    air.adhesion =
        reader.boolean("adhesion", {.fallback = air.adhesion, .doc = "the film holds the wet rim down"});
  };
  item.optional_object("air", "trapped by wet cloth, or within a closed one", read);
}

void read_solver(ObjectReader& item, cloth::ClothSettings& settings) {
  item.optional_object("solver", "between fast and exact", [&](ObjectReader& reader) {
    const auto dial = reader.choice<cloth::Dial>(
        "dial",
        {{"default", cloth::Dial::kDefault}, {"fast", cloth::Dial::kFast}, {"exact", cloth::Dial::kExact}},
        {.fallback = "default", .doc = "sets all the rest"});
    settings = cloth::settings_of(dial);
    Numbers number{reader};
    number("max_substep", settings.max_substep, Quantity::kTime, cloth::kMinSubstep, 1, "longest small step");
    number("march_step", settings.march_step, Quantity::kTime, 0, 1,
           "longest explicit step of a sheet over one bubble with air; 0: sweeps alone");
    number("max_move", settings.max_move, Quantity::kNumber, 0, 1000,
           "of hands and colliders a small step, over the spacing; 0: any");
    const auto integer = [&](std::string_view key, int& value, int low, int high, const std::string& doc) {
      value = reader.optional_integer(key, {.low = low, .high = high, .doc = doc}).value_or(value);
    };
    integer("max_substeps", settings.max_substeps, 1, 100000, "a step of the world");
    integer("sweeps", settings.sweeps, 1, 1000, "a small step");
    integer("coarse_every", settings.coarse_every, 0, 1000000, "small steps; 0: no coarse correction");
    integer("coarse_points", settings.coarse_points, 2, 64, "along a side of a coarse patch");
    settings.guard =
        reader.boolean("guard", {.fallback = settings.guard, .doc = "energy may not rise by itself"});
    const auto precision = reader.choice<int>("precision", {{"dial", 0}, {"single", 1}, {"double", 2}},
                                              {.fallback = "dial", .doc = "of the sweeps"});
    if (precision > 0) {
      settings.precision = precision == 1 ? cloth::Precision::kSingle : cloth::Precision::kDouble;
    }
  });
}

void read_paper(ObjectReader& item, std::optional<cloth::PaperSettings>& paper) {
  item.optional_object(
      "paper", "the thesis' explicit scheme instead of the solver: grids over one plane",
      [&](ObjectReader& reader) {
        cloth::PaperSettings settings;
        Numbers number{reader};
        number("step", settings.step, Quantity::kTime, cloth::kMinSubstep, 1, "longest step; 1/12000 s");
        settings.pressure =
            reader.choice<cloth::PaperPressure>("pressure",
                                                {{"constant_area", cloth::PaperPressure::kConstantArea},
                                                 {"volume_gradient", cloth::PaperPressure::kVolumeGradient}},
                                                {.fallback = "constant_area", .doc = "constant_area: (3.7)"});
        settings.friction = reader.choice<cloth::PaperFriction>(
            "friction",
            {{"forces", cloth::PaperFriction::kForces}, {"impulse", cloth::PaperFriction::kImpulse}},
            {.fallback = "forces", .doc = "forces: (3.4) and (3.5)"});
        number("sphere_diameter", settings.sphere_diameter, Quantity::kLength, 0, 0.1,
               "of the points against each other; 0: none");
        number("sphere_friction", settings.sphere_friction, Quantity::kNumber, 0, 10, "between them");
        settings.simd = reader.boolean("simd", {.fallback = settings.simd});
        settings.precision = reader.choice<cloth::Precision>(
            "precision", {{"double", cloth::Precision::kDouble}, {"single", cloth::Precision::kSingle}},
            {.fallback = "double"});
        paper = settings;
      });
}

}  // namespace

cloth::ClothDesign read_cloth_design(ObjectReader& item) {
  cloth::ClothDesign design;
  cloth::FabricPreset preset = cloth::fabric_preset(cloth::Weave::kPlain, cloth::Fiber::kPolyester);
  read_fabric(item, preset);
  design.fabric = preset.fabric;
  design.pattern = read_pattern(item, preset.fabric);
  double saturation = 0;
  std::vector<WetPatch> paint;
  read_wetness(item, preset.wetness, saturation, paint);
  design.wetness = preset.wetness;
  design.air = cloth::air_of(preset);
  read_air(item, design.air);
  read_solver(item, design.solver);
  read_paper(item, design.paper);
  item.optional_object("self_contact", "of the cloth with itself", [&](ObjectReader& reader) {
    design.self_contact.on = reader.boolean("on", {.fallback = true});
    design.self_contact.friction =
        reader.number("friction", {.low = 0.0, .high = 100.0, .fallback = design.self_contact.friction});
  });
  if (item.describing()) return design;
  try {
    cloth::check(design.fabric);
    cloth::check(design.wetness);
    cloth::check(design.air);
    cloth::check(design.solver, "solver");
    if (design.paper) cloth::check(*design.paper);
  } catch (const Error& error) {
    item.refuse(error.what());
  }
  for (const Vec3& x : design.pattern.points) {
    double here = saturation;
    for (const WetPatch& spot : paint) {
      if ((x - spot.at).norm() < spot.radius) here = spot.saturation;
    }
    design.saturation.push_back(here);
  }
  return design;
}

}  // namespace softpoint::inline SOFTPOINT_ABI::scene
