#pragma once

#include <vector>

#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Barycentric coordinates (the third is 1 - a - b) and weight; the weights of a rule add up to one.
struct RulePoint {
  double a, b, weight;
};
using Rule = std::vector<RulePoint>;

// Symmetric Gauss rules of 1, 3, 6 or 12 points: exact to degree 1, 2, 4, 6 (Dunavant 1985).
Rule symmetric_rule(int points);

// 3 n^2 points that crowd at edges and corners, for the steep layer potentials of neighbours.
// Equation (13) of doc/boundary_elements.md.
Rule graded_rule(int order);

// Those of a resolved Quadrature.
Rule far_rule(const Quadrature& quadrature);
Rule near_rule(const Quadrature& quadrature);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
