#pragma once

#include "softpoint/core/config.h"

// Which instruction set the heavy kernels of a plugin run with. A plugin builds its kernels once for each, in
// files of their own under `#pragma GCC target`, and chooses at run time. Such files must hold no inline
// function or template of the standard library or Eigen: the linker would merge a copy compiled for AVX into
// code that runs everywhere.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define SOFTPOINT_HAS_X86_KERNELS 1
#else
#define SOFTPOINT_HAS_X86_KERNELS 0  // the baseline alone
#endif

namespace softpoint::inline SOFTPOINT_ABI {

// Results differ in the last digits between them and are bit-identical within one.
enum class InstructionSet { kBaseline, kAvx2, kAvx512 };  // AVX2 with FMA; AVX-512 F, DQ and VL
// "baseline", "avx2", "avx512".
SOFTPOINT_API const char* name(InstructionSet set);
// The best one not beyond `limit` that this machine has, this library was built with, and the environment
// variable SOFTPOINT_MAX_ISA (baseline, avx2 or avx512; anything else is ignored) allows.
SOFTPOINT_API InstructionSet choose_instruction_set(InstructionSet limit);
SOFTPOINT_API InstructionSet best_instruction_set();

}  // namespace softpoint::inline SOFTPOINT_ABI
