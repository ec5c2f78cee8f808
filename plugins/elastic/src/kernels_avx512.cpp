// For processors with AVX-512 F, DQ and VL. The pragma does what the -m flags would, so that a plain
// compiler line without flags for single files builds this variant too.
#include "softpoint/core/instruction_set.h"

#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx512f,avx512dq,avx512vl,avx2,fma")
#define SOFTPOINT_KERNEL_NAME kernels_avx512
#define SOFTPOINT_KERNEL_LANES 8
#include "kernels-inl.h"
#else
#include "kernels.h"
namespace softpoint::inline SOFTPOINT_ABI::elastic {
const Kernels* kernels_avx512() { return nullptr; }
}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
#endif
