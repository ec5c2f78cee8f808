#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace softpoint::reference {

// The cross-section of a regular prism: what beam and torsion theory need of it.
struct PrismSection {
  double area = 0;           // m^2
  double second_moment = 0;  // m^4, about any axis through the centre
  double torsion = 0;        // m^4, Saint-Venant's constant J: torque = G J times twist per length
};

// Coefficients c_k of w = sum c_k z^(n k + 1), which maps the unit disc to the regular polygon with a corner
// at distance 1 (Schwarz and Christoffel: w' = C (1 - z^n)^(-2/n)).
inline std::vector<double> polygon_map(int sides, int terms) {
  const double n = sides;
  const double scale = n / std::beta(1.0 / n, 1.0 - 2.0 / n);
  std::vector<double> c(terms);
  double binomial = 1.0;
  for (int k = 0; k < terms; ++k) {
    c[k] = scale * binomial / (n * k + 1.0);
    binomial *= (2.0 / n + k) / (k + 1.0);
  }
  return c;
}

// Saint-Venant's torsion constant over the fourth power of the circumscribed radius. The warping is conjugate
// to the harmonic function that equals |w|^2 / 2 on the boundary, and Dirichlet's integral is the same on the
// disc: J = I_polar - pi n sum m b_m^2, where |w|^2 / 2 = b_0 / 2 + sum b_m cos(m n t). What is left out
// falls with terms^(4/n - 2), by which sums of half and of all terms are extrapolated.
inline double polygon_torsion(int sides, int terms = 4000) {
  const double n = sides, side = 2.0 * std::sin(std::numbers::pi / n);
  const double area = 0.5 * n * std::sin(2.0 * std::numbers::pi / n);
  const std::vector<double> c = polygon_map(sides, 2 * terms);
  double half = 0.0, all = 0.0;
  for (int m = 1; m < terms; ++m) {
    double b = 0.0;
    for (int k = 0; k + m < 2 * terms; ++k) b += c[k] * c[k + m];
    all += m * b * b;
    if (2 * m < terms) half = all;
  }
  const double tail = (all - half) / (std::pow(2.0, 2.0 - 4.0 / n) - 1.0);
  return area / 12.0 * (6.0 - side * side) - std::numbers::pi * n * (all + tail);
}

// `radius` is the circumscribed one.
inline PrismSection prism_section(int sides, double radius) {
  const double side = 2.0 * std::sin(std::numbers::pi / sides);
  PrismSection section;
  section.area = 0.5 * sides * std::sin(2.0 * std::numbers::pi / sides) * radius * radius;
  section.second_moment = section.area / 24.0 * (6.0 - side * side) * radius * radius;
  section.torsion = polygon_torsion(sides) * std::pow(radius, 4);
  return section;
}

// Shear coefficient of a solid circular section, which the 16-gon is to 1.3 % of its area: G. R. Cowper, "The
// shear coefficient in Timoshenko's beam theory", J. Appl. Mech. 33 (1966) 335.
inline double circular_shear_coefficient(double poisson) {
  return 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson);
}

}  // namespace softpoint::reference
