#pragma once

#include "kernels.h"
#include "softpoint/elastic/boundary_stiffness.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

// The kernels of the best instruction set not beyond `limit`, and which one that is.
InstructionSet choose_instruction_set(InstructionSet limit);
const Kernels& kernels_for(InstructionSet set);

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
