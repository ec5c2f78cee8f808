#pragma once

#include "softpoint/core/config.h"
#include "softpoint/core/triangle_mesh.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// What the system could give without swapping, bytes; infinite where that is not known.
double available_memory();

// Throws Error stating both sizes when `bytes` exceeds `limit`, or the available memory for a limit of 0.
void check_memory(const TriangleMesh& mesh, double bytes, double limit);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
