#pragma once

#include <memory>

#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// assemble_stiffness for those who still have something to add before it becomes immutable.
std::shared_ptr<BoundaryStiffness> assemble(const TriangleMesh& mesh, double poisson,
                                            const StiffnessSettings& settings);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
