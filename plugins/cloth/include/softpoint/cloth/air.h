#pragma once

#include <optional>
#include <string_view>

#include "softpoint/core/config.h"

namespace softpoint::inline SOFTPOINT_ABI::cloth {

// Which volumes of air a cloth knows.
enum class Bubbles {
  kOff,    // none: dry cloth, nothing is computed
  kOne,    // the thesis' bubble: the whole cloth down to its feet, whatever touches, sealed for ever
  kFound,  // as many as there are, found anew each frame; a closed cloth holds its own air
};

// Air between a wet cloth and what it lies on, and within a closed cloth. SI units. The numbers marked guess
// are to be set by whoever knows better.
struct AirSettings {
  Bubbles bubbles = Bubbles::kFound;
  double ambient = 101325;  // Pa, 0 to 1e9; standard atmosphere, as in the thesis
  // m3 at ambient pressure, 0 to 1e6: the air under the cloth, or in it, when it is made; absent: what is
  // there.
  std::optional<double> initial_volume;

  // Touch, found once a frame.
  double touch_gap = 0.3e-3;    // m, 0 to 1; a point nearer than this touches ...
  double release_gap = 1e-3;    // m, 0 to 1, at least touch_gap; ... until it is farther than this
  int lifetime = 3;             // frames, 1 to 1000, that a touch has to last before it parts bubbles
  double min_thickness = 1e-5;  // m, 0 to 1; the air of a thinner bubble rests on the contact patch

  // A wet patch that touches lets no air in from below: it lifts only where suction is at its limit. Bubbles
  // take the faces next to them along, so that peeling from a bubble's border is free.
  bool patch_suction = true;

  // Limits of suction.
  bool limit_suction = true;        // by the bubble point of the wet weave and by vapour pressure
  double surface_tension = 0.0728;  // N/m, 0 to 10; water at 20 degrees
  double contact_angle = 0;         // rad, 0 to pi/2; of water on the fibre: 0 wets it fully
  double pore_diameter = 50e-6;     // m, 1e-9 to 1; guess: 20 to 100 um are usual between yarns
  double vapour_pressure = 2340;    // Pa, 0 to 1e9; water at 20 degrees

  // Exchange with the atmosphere.
  bool leak = true;            // through the weave
  double permeability = 1e-3;  // m/(s Pa), 0 to 1e3, when dry; 0.1 m/s at 100 Pa, middle of dry satins
  bool vent = true;            // under the free rim, where it is not sealed; off: the rim is always sealed
  double viscosity = 18e-6;    // Pa s, 1e-9 to 1; air
  double film_gap = 200e-6;    // m, 1e-7 to 0.1; of the water film where the cloth touches; guess
  double bridge_gap = 2.7e-3;  // m, 0 to 1; no film spans more; capillary length of water
  double rim_width = 5e-3;     // m, 1e-6 to 1; length of the gap under the rim along the flow; guess
  double wet = 0.3;            // saturation, 0 to 1, from which a film seals and adheres; guess

  // Adhesion of the wet rim by its film, with a work of 2 gamma cos(theta) a square metre.
  bool adhesion = true;
};

// What the thesis assumes: one bubble of constant air over a plane, no limit, leak or adhesion.
SOFTPOINT_API AirSettings thesis_air(double initial_volume);

// Pressure difference at which air bursts through the pores of the wet weave, Pa: 4 gamma cos(theta)/d.
SOFTPOINT_API double bubble_point(const AirSettings& settings);
// Pressure difference that a film across a gap (m, not under film_gap) holds, Pa: 2 gamma cos(theta)/gap.
SOFTPOINT_API double film_pressure(const AirSettings& settings, double gap);
// Adhesion (Pa) by a film that is film_gap thick at the gap 0 and keeps its water while the gap (m) opens:
// its pressure falls with its thickness, and so does the area it covers. Integrated over the gap it gives the
// work of 2 gamma cos(theta) a square metre.
SOFTPOINT_API double film_adhesion(const AirSettings& settings, double gap);

// Throws Error naming the field, as "<name>.ambient" and so on, its value and the permitted range.
SOFTPOINT_API void check(const AirSettings& settings, std::string_view name = "air");

}  // namespace softpoint::inline SOFTPOINT_ABI::cloth
