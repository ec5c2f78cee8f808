#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "support/prism_section.h"

// The geometrically exact beam (Reissner 1972, Simo 1985) in a plane: a cantilever under a dead force and a
// moment at its tip, large rotations included. Axis z, deflection along x, rotation theta about y.
namespace softpoint::reference {

struct Beam {
  double length = 1;   // m
  double axial = 1;    // E A, N
  double shear = 1;    // k G A, N
  double bending = 1;  // E I, N m^2
};

// The beam with the cross-section of a regular prism.
inline Beam prism_beam(int sides, double radius, double length, double young, double poisson) {
  const PrismSection section = prism_section(sides, radius);
  return {length, young * section.area,
          circular_shear_coefficient(poisson) * young / (2.0 * (1.0 + poisson)) * section.area,
          young * section.second_moment};
}

// Both keep their direction in space.
struct TipLoad {
  double force_x = 0;  // N
  double force_z = 0;  // N, along the undeformed axis
  double moment = 0;   // N m, about y
};

struct BeamPoint {
  double x = 0, z = 0;  // m, of the centre line
  double theta = 0;     // rad, of the cross-section
  double moment = 0;    // N m
};

// d/ds of a point: the force is the same at every cross-section, because the load is dead.
inline std::array<double, 4> beam_slope(const Beam& beam, const TipLoad& load, const BeamPoint& p) {
  const double s = std::sin(p.theta), c = std::cos(p.theta);
  const double stretch = 1.0 + (load.force_x * s + load.force_z * c) / beam.axial;
  const double slide = (load.force_x * c - load.force_z * s) / beam.shear;
  const double dx = stretch * s + slide * c, dz = stretch * c - slide * s;
  return {dx, dz, p.moment / beam.bending, dx * load.force_z - dz * load.force_x};
}

inline BeamPoint beam_moved(const BeamPoint& p, const std::array<double, 4>& slope, double ds) {
  return {p.x + ds * slope[0], p.z + ds * slope[1], p.theta + ds * slope[2], p.moment + ds * slope[3]};
}

// From the clamp with a guessed moment there: the classical Runge-Kutta method in equal steps.
inline std::vector<BeamPoint> shoot_beam(const Beam& beam, const TipLoad& load, double root_moment,
                                         int steps) {
  std::vector<BeamPoint> line(1);
  line.reserve(steps + 1);
  line[0].moment = root_moment;
  const double h = beam.length / steps;
  for (int i = 0; i < steps; ++i) {
    const BeamPoint p = line.back();
    const auto a = beam_slope(beam, load, p);
    const auto b = beam_slope(beam, load, beam_moved(p, a, 0.5 * h));
    const auto c = beam_slope(beam, load, beam_moved(p, b, 0.5 * h));
    const auto d = beam_slope(beam, load, beam_moved(p, c, h));
    std::array<double, 4> mean;
    for (int k = 0; k < 4; ++k) mean[k] = (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]) / 6.0;
    line.push_back(beam_moved(p, mean, h));
  }
  return line;
}

// The root moment for which the tip carries the moment asked for: secants, started from `guess`.
inline double beam_root_moment(const Beam& beam, const TipLoad& load, double guess, int steps) {
  const auto miss = [&](double moment) {
    return shoot_beam(beam, load, moment, steps).back().moment - load.moment;
  };
  const double scale = beam.bending / beam.length;
  double m0 = guess, m1 = guess + 1e-3 * scale, e0 = miss(m0);
  for (int i = 0; i < 100; ++i) {
    const double e1 = miss(m1);
    if (std::abs(e1) <= 1e-14 * (scale + std::abs(m1)) || e1 == e0) return m1;
    const double next = m1 - e1 * (m1 - m0) / (e1 - e0);
    m0 = m1, e0 = e1, m1 = next;
  }
  throw std::runtime_error("exact beam: the root moment was not found; apply the load in more stages");
}

// Positions from the clamp to the tip. The load is applied in stages, so that the solution is the one
// connected with the straight beam; steps are doubled until the tip stands still to `tolerance` of the
// length.
inline std::vector<BeamPoint> solve_beam(const Beam& beam, const TipLoad& load, double tolerance = 1e-11) {
  double root = 0.0;
  int steps = 32;
  for (int stage = 1; stage <= 16; ++stage) {
    const double part = stage / 16.0;
    root =
        beam_root_moment(beam, {part * load.force_x, part * load.force_z, part * load.moment}, root, steps);
  }
  std::vector<BeamPoint> line = shoot_beam(beam, load, root, steps);
  while (steps < (1 << 16)) {
    steps *= 2;
    root = beam_root_moment(beam, load, root, steps);
    std::vector<BeamPoint> finer = shoot_beam(beam, load, root, steps);
    const double change = std::hypot(finer.back().x - line.back().x, finer.back().z - line.back().z);
    line = std::move(finer);
    if (change <= tolerance * beam.length) return line;
  }
  throw std::runtime_error("exact beam: not converged");
}

// The sideways tip force at which the tip has moved `fraction` of the length sideways.
inline double force_for_deflection(const Beam& beam, double fraction) {
  const double target = fraction * beam.length;
  double f0 = 0.0, d0 = 0.0;
  double f1 = 3.0 * beam.bending * target / std::pow(beam.length, 3);
  for (int i = 0; i < 50; ++i) {
    const double d1 = solve_beam(beam, {f1, 0.0, 0.0}).back().x;
    if (std::abs(d1 - target) <= 1e-10 * beam.length) return f1;
    const double next = f1 + (target - d1) * (f1 - f0) / (d1 - d0);
    f0 = f1, d0 = d1, f1 = next;
  }
  throw std::runtime_error("exact beam: no tip force gives that deflection");
}

}  // namespace softpoint::reference
