#pragma once

#include <vector>

#include "panels.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// Makes the lower triangle of S (3V x 3V, Young's modulus 1 Pa) exact for every affine displacement and
// mirrors it. Equation (16) of doc/boundary_elements.md. `points` are the vertices, near the origin.
void correct_affine(const Panels& panels, const std::vector<Vec3>& points, double poisson,
                    std::vector<double>& stiffness);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
