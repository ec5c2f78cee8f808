#include "softpoint/core/instruction_set.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace softpoint::inline SOFTPOINT_ABI {
namespace {

bool machine_has(InstructionSet set) {
#if SOFTPOINT_HAS_X86_KERNELS
  switch (set) {
    case InstructionSet::kBaseline:
      return true;
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case InstructionSet::kAvx512:
      return machine_has(InstructionSet::kAvx2) && __builtin_cpu_supports("avx512f") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
  }
  return false;
#else
  return set == InstructionSet::kBaseline;
#endif
}

InstructionSet limit_of_environment() {
  const char* text = std::getenv("SOFTPOINT_MAX_ISA");
  const std::string_view value = text == nullptr ? "" : text;
  if (value == "baseline") return InstructionSet::kBaseline;
  if (value == "avx2") return InstructionSet::kAvx2;
  return InstructionSet::kAvx512;
}

}  // namespace

const char* name(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx512:
      return "avx512";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kBaseline:
      break;
  }
  return "baseline";
}

InstructionSet choose_instruction_set(InstructionSet limit) {
  const InstructionSet most = std::min(limit, limit_of_environment());
  for (InstructionSet set : {InstructionSet::kAvx512, InstructionSet::kAvx2}) {
    if (set <= most && machine_has(set)) return set;
  }
  return InstructionSet::kBaseline;
}

InstructionSet best_instruction_set() { return choose_instruction_set(InstructionSet::kAvx512); }

}  // namespace softpoint::inline SOFTPOINT_ABI
