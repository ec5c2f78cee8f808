// For processors with AVX2 and FMA. The pragma does what -mavx2 -mfma would, so that a plain compiler
// line without flags for single files builds this variant too.
#include "softpoint/core/instruction_set.h"

#if SOFTPOINT_HAS_X86_KERNELS
#pragma GCC target("avx2,fma")
#define SOFTPOINT_KERNEL_NAME kernels_avx2
#define SOFTPOINT_KERNEL_LANES 4
#include "kernels-inl.h"
#else
#include "kernels.h"
namespace softpoint::inline SOFTPOINT_ABI::elastic {
const Kernels* kernels_avx2() { return nullptr; }
}  // namespace softpoint::inline SOFTPOINT_ABI::elastic
#endif
