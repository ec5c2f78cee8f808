#pragma once

#include <Eigen/Core>

#include <vector>

#include "softpoint/elastic/statics.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The conditions of a problem by degree of freedom (3 v + component).
struct StaticLoads {
  std::vector<char> held;
  Eigen::VectorXd displacement;  // m, zero where free
  Eigen::VectorXd nodal;         // N, the tractions shared out to the vertices
};

// Throws Error for indices out of range, numbers that are not finite, and a component held twice at
// different values, naming the entry as in "displacement[2].vertices[5]".
StaticLoads gather_loads(const StaticProblem& problem);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
