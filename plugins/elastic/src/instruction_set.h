#pragma once

#include "kernels.h"
#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// For a set that choose_instruction_set() gave.
const Kernels& kernels_for(InstructionSet set);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
