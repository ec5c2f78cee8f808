#include "instruction_set.h"

namespace softpoint::inline SOFTPOINT_ABI::elastic {

const Kernels& kernels_for(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return *kernels_avx512();
    case InstructionSet::kAvx2:
      return *kernels_avx2();
    case InstructionSet::kBaseline:
      break;
  }
  return *kernels_baseline();
}

}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
