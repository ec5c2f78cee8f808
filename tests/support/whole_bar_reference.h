#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "support/bar_mesh.h"
#include "support/prism_section.h"

// Linear answers for whole bars of N cylinders with both caps clamped to rigid plates (nu = 0.3), from
// refined meshes of the one bar (build/bin/whole_bar_reference; figures for E = 1 Pa, r = 0.5 m, parts of 1
// m):
//
//   N level vertices        stretch          twist           bend
//   2     1      146   0.3927419736   0.0184488134   0.0239376706
//   2     2      610   0.3925242098   0.0180006078   0.0238036397
//   2     3     1394   0.3925283131   0.0179240322   0.0237877057
//   2     4     2498   0.3925433272   0.0179081720   0.0237839555
//   4     1      210   0.1938235332   0.0094900379   0.0120605943
//   4     2      866   0.1937708773   0.0090329413   0.0118097307
//   4     3     1970   0.1937718212   0.0089708499   0.0117826711
//   7     1      306   0.1101440220   0.0054925667   0.0069118042
//   7     2     1250   0.1101270535   0.0051684096   0.0067254969
//
// Away from the plates the bar is Saint-Venant's, so its compliance is N over E A, G J or E I less an end
// correction that does not depend on N. Extrapolated over the levels, the corrections are, in 1/m, 1/m^3 and
// 1/m^3,
//   stretch 0.06575 (N = 2), 0.0656 (N = 4); twist 0.024 (N = 2); bend 0.8488 (N = 2), 0.8489 (N = 4),
// and for 7 and 13 cylinders the stiffness is known to about 2e-5, 3e-4 and 5e-5 of itself: stretch 0.110128
// and 0.0591026, twist 0.0051123 and 0.0027526, bend 0.0066981 and 0.0035972. The correction of bending is
// that of two rigid pieces, one at each plate, of `bend_clamp` length.
namespace softpoint::reference {

// Forces that move the plates, E = 1 Pa.
struct BarStiffness {
  double stretch = 0;  // force over the change of length, m
  double twist = 0;    // torque over the angle between the plates about z, m^3
  double bend = 0;     // moment over the angle between the plates, turned oppositely about y, m^3: no shear
};

// m: a plate keeps so much of the bar beside it straight.
inline double bend_clamp() { return 0.5 * 0.8489 * prism_section(kSides, kRadius).second_moment; }

inline BarStiffness whole_bar_stiffness(int parts) {
  static const PrismSection section = prism_section(kSides, kRadius);
  const double length = parts * kPartLength;
  return {1.0 / (length / section.area - 0.0656), 1.0 / (2.6 * length / section.torsion - 0.024),
          1.0 / (length / section.second_moment - 0.8489)};
}

// The stretched bar near a plate, for a strain of 1 far from it: distance from the plate (m), radial
// displacement of the prism's edges (m), and how far they have come nearer to, or gone away from, the plate
// (m). Level 3 of N = 4.
struct EndRow {
  double distance, radial, away;
};
inline constexpr EndRow kStretchedEnd[] = {
    {0.00000, 0.00000, 0.00000},  {0.02406, -0.03809, 0.04364}, {0.06804, -0.07605, 0.08534},
    {0.12500, -0.10378, 0.13892}, {0.19245, -0.12509, 0.19630}, {0.26896, -0.13794, 0.26465},
    {0.35355, -0.14610, 0.34131}, {0.44553, -0.14979, 0.42799}, {0.54433, -0.15132, 0.52295},
    {0.64952, -0.15148, 0.62609}, {0.76073, -0.15115, 0.73613}, {0.87764, -0.15074, 0.85260},
    {1.00000, -0.15039, 0.97480}, {1.16667, -0.15014, 1.14147}, {1.33333, -0.15003, 1.30818},
    {1.50000, -0.15000, 1.47487}, {1.66667, -0.14999, 1.64155}, {1.83333, -0.14999, 1.80822},
    {2.00000, -0.14999, 1.97489}};

// Of a bar whose length changes by 1 m: radial displacement of the edges at a distance from the nearer plate,
// and the displacement along z away from the bar's middle.
inline std::pair<double, double> stretched(int parts, double distance) {
  static const double area = prism_section(kSides, kRadius).area;
  const double strain = whole_bar_stiffness(parts).stretch / area;
  const EndRow* const last = std::end(kStretchedEnd) - 1;
  if (distance >= last->distance) {
    return {strain * last->radial, strain * (0.5 * parts * kPartLength - distance)};
  }
  const EndRow* above = kStretchedEnd;
  while (above->distance <= distance) ++above;
  const EndRow &a = above[-1], &b = *above;
  const double t = (distance - a.distance) / (b.distance - a.distance);
  return {strain * (a.radial + t * (b.radial - a.radial)), 0.5 - strain * (a.away + t * (b.away - a.away))};
}

}  // namespace softpoint::reference
